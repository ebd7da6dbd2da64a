// SPDX-License-Identifier: BSD-3-Clause
#include "cli/query_options.h"

#include <algorithm>
#include <chrono>
#include <functional>
#include <limits>

#include "cli/input_file.h"
#include "dispatch/single_run.h"
#include "mesh_io/mesh_file.h"
#include "scenes/opencl_drivers.h"

namespace otg::cli {
namespace {

template <class T>
struct Named {
  const char* name;
  T value;
};

constexpr Named<Traversal> kTraversals[] = {{"standard", Traversal::kStandard},   {"quantized", Traversal::kQuantized},
                                            {"noleaf", Traversal::kNoLeaf},       {"wide", Traversal::kWide},
                                            {"quantised", Traversal::kQuantized}, {"no-leaf", Traversal::kNoLeaf}};
constexpr Named<DescentRule> kDescents[] = {{"first", DescentRule::kFirstTreeFirst},
                                            {"larger", DescentRule::kLargerFirst},
                                            {"alternating", DescentRule::kAlternating},
                                            {"both", DescentRule::kBoth}};
constexpr Named<BuildStrategy> kBuilds[] = {{"mean", BuildStrategy::kMeanSplit}, {"sah", BuildStrategy::kSah}};
constexpr Named<opencl::PrefixSums> kPrefixSums[] = {{"published", opencl::PrefixSums::kPublished},
                                                     {"work-efficient", opencl::PrefixSums::kWorkEfficient},
                                                     {"single-pass", opencl::PrefixSums::kSinglePass}};
constexpr Named<Reduction> kReductions[] = {
    {"none", Reduction::kNone}, {"binning", Reduction::kBinning}, {"cone", Reduction::kCone}};

template <class T, std::size_t N>
T find(const Named<T> (&table)[N], const std::string& name) {
  for (const auto& entry : table) {
    if (name == entry.name) return entry.value;
  }
  throw UsageError("unknown value " + name);  // the parser has checked already
}

template <class T, std::size_t N>
const char* nameIn(const Named<T> (&table)[N], T value) {
  for (const auto& entry : table) {
    if (value == entry.value) return entry.name;
  }
  return "?";
}

/// One command uses few of the kernels.
opencl::Tuning whenUsed() {
  opencl::Tuning tuning;
  tuning.warmUp = false;
  return tuning;
}

}  // namespace

const char* nameOf(Traversal traversal) {
  return nameIn(kTraversals, traversal);
}
const char* nameOf(DescentRule rule) {
  return nameIn(kDescents, rule);
}
const char* nameOf(BuildStrategy strategy) {
  return nameIn(kBuilds, strategy);
}

void QueryOptions::addInputOptions(CLI::App& command) {
  command.add_option("A", fileA, "Mesh A")->required();
  command.add_option("B", fileB, "Mesh B")->required();
  command.add_option("--pose", pose, "B in A's frame: tx,ty,tz,qw,qx,qy,qz, or a file with a 4x4 row-major matrix");
  command
      .add_option("--midphase", midphase,
                  "Middle phase: where it runs, or which traversal of the trees on the CPU; levels: the published "
                  "traversal on an OpenCL device")
      ->check(CLI::IsMember(
          {"auto", "cpu", "opencl", "standard", "quantized", "quantised", "noleaf", "no-leaf", "wide", "levels"}));
  command
      .add_option("--nearphase", nearphase,
                  "Near phase: where it runs; on an OpenCL device, of gathered triangles, published: contacts "
                  "first, without a test; filtered: the test first")
      ->check(CLI::IsMember({"auto", "cpu", "exact", "opencl", "published", "filtered"}));
  command.add_option("--descent", descent, "Which tree a traversal descends")
      ->check(CLI::IsMember({"first", "larger", "alternating", "both"}));
  command.add_option("--axes", axes, "Axes of a box test on the CPU")->check(CLI::IsMember({6, 15}));
  command.add_option("--start-depth", levels.startDepth, "levels: depth of the nodes that are tested all against all")
      ->check(CLI::Range(0u, opencl::kMostStartDepth));
  command.add_flag(
      "--send-trees", levels.sendTrees,
      "levels: send with every query what the device needs of the meshes: nodes, where the narrow phase is "
      "cpu, published or filtered; else triangles, too");
  command.add_option("--prefix-sums", prefixSums, "levels: how places in lists are found")
      ->check(CLI::IsMember({"published", "work-efficient", "single-pass"}));
  command.add_flag("--split-near", splitNear, "levels: test triangles and make contacts in two kernels, not in one");
  addBackendOptions(command);
}

void QueryOptions::addBackendOptions(CLI::App& command) {
  command.add_option("--backend", backend, "Where queries run (cpu); auto: where it is expected to be faster, or both")
      ->check(CLI::IsMember({"auto", "cpu", "opencl"}));
  command.add_option("--build", build, "How the trees are built")->check(CLI::IsMember({"mean", "sah"}));
  command.add_option("--device", devices, "OpenCL devices, as `otg devices` numbers them: I,I,...; a batch is divided")
      ->delimiter(',')
      ->check(CLI::NonNegativeNumber);
}

void QueryOptions::addThreadOption(CLI::App& command) {
  command.add_option("--threads", threads, "Threads of the CPU; 0: one for each core (or OTG_THREADS)")
      ->check(CLI::Range(0, 1024));
}

void QueryOptions::addContactOptions(CLI::App& command) {
  command
      .add_option(
          "--contacts", contacts,
          "Contact model; auto: pairwise if a reduction is named, else solid (other meshes: contacts of shells)")
      ->check(CLI::IsMember({"auto", "pairwise", "solid"}));
  command.add_option("--reduction", reduction, "How contacts are reduced")
      ->check(CLI::IsMember({"none", "binning", "cone"}));
  command.add_option("--bins", bins, "Bins per axis: one number for all, or six: position x y z, normal x y z")
      ->delimiter(',')
      ->expected(1, 6)
      ->check(CLI::Range(1, 64));
  command.add_option("--max-contacts", maxContacts, "No more contacts than this")->check(CLI::Range(1, 65535));
  command
      .add_option("--max-pairs", maxPairs,
                  "The CPU gives up a pair of meshes with more pairs of triangles whose boxes overlap")
      ->check(CLI::Range(1, std::numeric_limits<int>::max()));
  command
      .add_option("--contacts-per-region", contactsPerRegion,
                  "Contact model solid: no more contacts than this for one connected overlap")
      ->check(CLI::Range(1, 64));
  command
      .add_option("--region-merge", regionMerge,
                  "Contact model solid: regions that come nearer to each other than this and push the same way are one")
      ->check(CLI::Range(0.0, 1e30));
}

CollideOptions QueryOptions::collideOptions() const {
  CollideOptions options;
  if (!midphase.empty() && midphase != "cpu" && midphase != "auto" && midphase != "opencl" && !isLevels())
    options.middle.traversal = find(kTraversals, midphase);
  if (!descent.empty()) options.middle.descent = find(kDescents, descent);
  options.middle.axes = axes;
  // Reductions are of contacts between pairs of triangles (`solid` chooses its own), so whoever names one means those.
  const bool reduces = !reduction.empty() || !bins.empty();
  const bool pairwise = contacts == "pairwise" || (contacts == "auto" && reduces);
  options.contacts = pairwise ? ContactModel::kPairwise : ContactModel::kSolid;
  options.reduction.method = find(kReductions, reduction.empty() ? "binning" : reduction);
  if (bins.size() == 1) {
    options.reduction.bins.fill(bins[0]);
  } else if (bins.size() == 6) {
    std::copy(bins.begin(), bins.end(), options.reduction.bins.begin());
  } else if (!bins.empty()) {
    throw UsageError("--bins takes one number or six");
  }
  options.maxContacts = maxContacts;
  options.middle.maxPairs = maxPairs;
  options.solid.contactsPerRegion = contactsPerRegion;
  options.solid.regionMerge = regionMerge;
  options.solid.convexPath = true;
  return options;
}

Placement QueryOptions::placement() const {
  const auto place = [](const std::string& word, Place otherwise) {
    if (word.empty()) return otherwise;
    return word == "opencl" ? Place::kOpencl : word == "auto" ? Place::kAuto : Place::kCpu;
  };
  if (isLevels()) {
    if (backend == "cpu") throw UsageError("--midphase levels runs on an OpenCL device");
    return {Place::kOpencl, nearphase == "cpu" || nearphase == "exact" ? Place::kCpu : Place::kOpencl};
  }
  if (isGatheredNear()) return {midphase == "opencl" ? Place::kOpencl : Place::kCpu, Place::kOpencl};
  const Place all = place(backend, Place::kCpu);
  // "exact" and the names of traversals say how, and where no more than that it is the CPU.
  return settled({place(midphase, all), place(nearphase == "exact" ? "" : nearphase, all)});
}

opencl::LevelsOptions QueryOptions::levelsOptions() const {
  opencl::LevelsOptions options = levels;
  options.fusedNear = !splitNear;
  options.prefixSums = find(kPrefixSums, prefixSums);
  return options;
}

std::optional<Mixture> QueryOptions::mixture() const {
  const Placement place = placement();
  if (!isGatheredNear() && !(isLevels() && place.near == Place::kCpu)) return std::nullopt;
  if (splitNear) throw UsageError("--split-near is of a narrow phase that follows on the device");
  Mixture mixture;
  mixture.middle = isLevels()                       ? Mixture::Middle::kLevels
                   : place.middle == Place::kOpencl ? Mixture::Middle::kDevice
                                                    : Mixture::Middle::kCpu;
  mixture.near = nearphase == "published"  ? Mixture::Near::kContactsFirst
                 : nearphase == "filtered" ? Mixture::Near::kFilterFirst
                                           : Mixture::Near::kCpu;
  mixture.levels = levelsOptions();
  return mixture;
}

std::vector<int> QueryOptions::deviceNumbers() const {
  if (placement() == Placement{Place::kCpu, Place::kCpu}) {
    if (!devices.empty()) progress("note: --device chooses an OpenCL device; the query runs on the CPU");
    return {};
  }
  const std::vector<opencl::DeviceInfo> all = findDevices();
  if (!devices.empty()) {
    for (const int index : devices) {
      if (index < static_cast<int>(all.size())) continue;
      throw InputError("there is no OpenCL device " + std::to_string(index) + "; `otg devices` lists what there is");
    }
    return devices;
  }
  const int index = opencl::defaultDevice(all);
  if (index >= 0 && placement() == Placement{} && !takesAuto(all[static_cast<std::size_t>(index)])) return {};
  if (index >= 0) return {index};
  if (placement() != Placement{}) {  // auto can do without
    progress("note: no OpenCL device can be used (`otg devices` lists what there is); the CPU computes");
  }
  return {};
}

std::shared_ptr<opencl::Backend> QueryOptions::openBackend() const {
  if (!mixture() && placement() != Placement{Place::kOpencl, Place::kOpencl}) return nullptr;
  const std::vector<int> numbers = deviceNumbers();
  if (numbers.empty()) return nullptr;
  std::shared_ptr<opencl::Backend> opened = opencl::Backend::open(numbers[0], whenUsed());
  if (!opened) {
    progress("note: the OpenCL device " + std::to_string(numbers[0]) + " cannot be used; the CPU computes");
  }
  return opened;
}

std::unique_ptr<Dispatcher> QueryOptions::openDispatcher() const {
  auto dispatcher = std::make_unique<Dispatcher>();
  dispatcher->setThreadCount(static_cast<unsigned>(threads));
  const std::vector<int> numbers = deviceNumbers();
  // Where pairs go is given, and blocks for equal devices need no costs.
  const bool areEqual = std::adjacent_find(numbers.begin(), numbers.end(), std::not_equal_to<>()) == numbers.end();
  const Costs costs = placement() != Placement{} && areEqual ? Costs::kIfStored : Costs::kMeasured;
  const std::size_t opened = dispatcher->open(numbers, whenUsed(), costs);
  if (opened < numbers.size()) {
    progress(opened == 0 ? "note: no OpenCL device can be used; the CPU computes"
                         : "note: an OpenCL device cannot be used; the others and the CPU compute");
  }
  return dispatcher;
}

BuildStrategy QueryOptions::buildStrategy() const {
  return build.empty() ? BuildStrategy::kSah : find(kBuilds, build);
}

LoadedPair loadPair(const QueryOptions& options, int repeat) {
  using Clock = std::chrono::steady_clock;
  const bool same = options.fileA == options.fileB;
  const std::shared_ptr<const TriMesh> a = mesh_io::loadTriMesh(findInput(options.fileA), {}, MeshOrder::kBySize);
  const std::shared_ptr<const TriMesh> b =
      same ? a : mesh_io::loadTriMesh(findInput(options.fileB), {}, MeshOrder::kBySize);
  LoadedPair pair;
  std::vector<double> times;
  for (int i = 0; i < repeat; ++i) {
    const auto start = Clock::now();
    pair.a = std::make_shared<CollisionMesh>(a, options.buildStrategy());
    pair.b = same ? pair.a : std::make_shared<CollisionMesh>(b, options.buildStrategy());
    times.push_back(std::chrono::duration<double, std::milli>(Clock::now() - start).count());
  }
  pair.buildMs = median(times);
  return pair;
}

std::string hashOf(const std::vector<Contact>& contacts) {
  Fnv1a hash;
  for (const Contact& contact : contacts) {
    hash.add(contact.position);
    hash.add(contact.normal);
    hash.add(contact.depth);
    hash.add(contact.triangleA);
    hash.add(contact.triangleB);
  }
  return hash.hex();
}

std::vector<opencl::DeviceInfo> findDevices() {
  if (scenes::driversSurviveListing()) return opencl::listDevices();
  progress("note: the OpenCL driver ends programs that ask for its devices; none is used");
  return {};
}

}  // namespace otg::cli
