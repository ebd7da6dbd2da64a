// SPDX-License-Identifier: BSD-3-Clause
// harness/viewer/run_data.js reads what is written here.
#include "scenes/html_page.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <limits>
#include <map>
#include <nlohmann/json.hpp>
#include <stdexcept>

#include "base/vectors.h"
#include "scenes/shaded_surface.h"

namespace otg::scenes {
namespace {

using PageJson = nlohmann::ordered_json;

std::string base64(const std::vector<std::uint8_t>& bytes) {
  static constexpr char kDigits[] = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string text;
  text.reserve((bytes.size() + 2) / 3 * 4);
  for (std::size_t i = 0; i < bytes.size(); i += 3) {
    const std::size_t count = std::min<std::size_t>(3, bytes.size() - i);
    std::uint32_t bits = 0;
    for (std::size_t k = 0; k < 3; ++k) bits = bits << 8 | (k < count ? bytes[i + k] : 0u);
    for (std::size_t k = 0; k < 4; ++k) text += k <= count ? kDigits[bits >> (18 - 6 * k) & 63] : '=';
  }
  return text;
}

/// Numbers of one kind, as little-endian bytes.
class Numbers {
 public:
  template <class T>
  void add(T value) {
    static_assert(std::is_unsigned_v<T>);
    for (std::size_t i = 0; i < sizeof(T); ++i) bytes_.push_back(static_cast<std::uint8_t>(value >> 8 * i));
  }
  void addFloat(double value) { add(std::bit_cast<std::uint32_t>(static_cast<float>(value))); }
  void addFloats(const Vec3d& v) {
    for (const double x : {v.x, v.y, v.z}) addFloat(x);
  }
  /// [-1, 1] as a signed byte.
  void addSignedByte(double x) {
    add(static_cast<std::uint8_t>(static_cast<std::int8_t>(std::lround(127 * std::clamp(x, -1.0, 1.0)))));
  }
  /// [-1, 1] as a signed integer of 16 bits.
  void addSignedShort(double x) {
    add(static_cast<std::uint16_t>(static_cast<std::int16_t>(std::lround(32767 * std::clamp(x, -1.0, 1.0)))));
  }
  /// A multiple of the step as an integer of 16 bits.
  void addSteps(double x, double step) {
    add(static_cast<std::uint16_t>(step > 0 ? std::clamp(std::round(x / step), 0.0, 65535.0) : 0));
  }
  std::string text() const { return base64(bytes_); }

 private:
  std::vector<std::uint8_t> bytes_;
};

/// Points as multiples of a step from a corner, 16 bits each.
struct Grid {
  Vec3d low{0, 0, 0};
  double step = 0;
};

/// `pointAt(i)` for i below `count`.
template <class PointAt>
Grid gridAround(std::size_t count, const PointAt& pointAt) {
  if (count == 0) return {};
  Vec3d low = pointAt(0), high = low;
  for (std::size_t i = 1; i < count; ++i) {
    low = minimum(low, pointAt(i));
    high = maximum(high, pointAt(i));
  }
  const Vec3d size = high - low;
  return {low, std::max({size.x, size.y, size.z}) / 65535};
}

void addOnGrid(Numbers& numbers, const Grid& grid, const Vec3d& p) {
  const Vec3d d = p - grid.low;
  for (const double x : {d.x, d.y, d.z}) numbers.addSteps(x, grid.step);
}

PageJson toArray(const Vec3d& v) {
  return PageJson::array({v.x, v.y, v.z});
}

PageJson describe(const TriMesh& mesh) {
  const ShadedSurface surface = shade(mesh);
  const std::size_t count = surface.positions.size() / 3;
  const auto pointAt = [&](std::size_t i) {
    const float* p = &surface.positions[3 * i];
    return Vec3d{p[0], p[1], p[2]};
  };
  const Grid grid = gridAround(count, pointAt);
  Numbers positions, normals, indices;
  for (std::size_t i = 0; i < count; ++i) addOnGrid(positions, grid, pointAt(i));
  for (const float x : surface.normals) normals.addSignedByte(x);
  const bool small = count <= 65536;
  for (const std::uint32_t i : surface.indices) {
    if (small)
      indices.add(static_cast<std::uint16_t>(i));
    else
      indices.add(i);
  }
  return {{"vertices", count},
          {"triangles", surface.indices.size() / 3},
          {"low", toArray(grid.low)},
          {"step", grid.step},
          {"index_bits", small ? 16 : 32},
          {"positions", positions.text()},
          {"normals", normals.text()},
          {"indices", indices.text()}};
}

PageJson describe(const AnimatedBody& body, std::size_t surface) {
  Numbers positions, rotations;
  for (const Vec3d& p : body.positions) positions.addFloats(p);
  for (const auto& q : body.rotations) {
    for (const double x : q) rotations.addSignedShort(x);
  }
  return {{"name", body.name},
          {"surface", surface},
          {"color", toArray(body.color)},
          {"poses", body.positions.size()},
          {"positions", positions.text()},
          {"rotations", rotations.text()}};
}

PageJson describeContacts(const Recording& recording) {
  Numbers starts, corners, steps, positions, directions, depths;
  std::uint32_t count = 0;
  double deepest = 0;
  for (const auto& frame : recording.contacts) {
    for (const ContactArrow& arrow : frame) deepest = std::max(deepest, arrow.depth);
  }
  const double depthStep = deepest / 65535;
  starts.add(count);
  for (const auto& frame : recording.contacts) {
    const Grid grid = gridAround(frame.size(), [&](std::size_t i) { return frame[i].position; });
    corners.addFloats(grid.low);
    steps.addFloat(grid.step);
    for (const ContactArrow& arrow : frame) {
      addOnGrid(positions, grid, arrow.position);
      for (const double x : {arrow.direction.x, arrow.direction.y, arrow.direction.z}) directions.addSignedByte(x);
      depths.addSteps(arrow.depth, depthStep);
    }
    count += static_cast<std::uint32_t>(frame.size());
    starts.add(count);
  }
  PageJson colors = PageJson::array();
  for (const Vec3d& color : kDepthColors) colors.push_back(toArray(color));
  return {{"count", count},
          {"usual_depth", usualDepth(recording)},
          {"depth_step", depthStep},
          {"colors", colors},
          {"starts", starts.text()},
          {"low", corners.text()},
          {"step", steps.text()},
          {"positions", positions.text()},
          {"directions", directions.text()},
          {"depths", depths.text()}};
}

PageJson describeSteps(const Recording& recording) {
  Numbers contacts, kinetic, potential;
  for (const StepFigures& step : recording.steps) {
    contacts.add(static_cast<std::uint32_t>(step.record.contacts));
    kinetic.addFloat(step.energy.kinetic);
    potential.addFloat(step.energy.potential);
  }
  return {{"count", recording.steps.size()},
          {"contacts", contacts.text()},
          {"kinetic", kinetic.text()},
          {"potential", potential.text()}};
}

PageJson describe(const std::string& title, const Recording& recording) {
  const Stage stage = findStage(recording.bodies);
  PageJson run = {{"format", "ode_trimesh_gpu run"},
                  {"version", 1},
                  {"title", title},
                  {"dt", recording.dt},
                  {"steps_per_frame", recording.stepsPerFrame},
                  {"frames", recording.times.size()},
                  {"stage", {{"center", toArray(stage.center)}, {"radius", stage.radius}}},
                  {"view_from", toArray(kViewFrom)}};
  run["planes"] = PageJson::array();
  for (const PlaneDescription& plane : recording.planes) {
    run["planes"].push_back({{"normal", toArray(plane.normal)}, {"offset", plane.offset}});
  }
  run["surfaces"] = PageJson::array();
  run["bodies"] = PageJson::array();
  std::map<const TriMesh*, std::size_t> surfaces;
  for (const AnimatedBody& body : recording.bodies) {
    const auto [place, isNew] = surfaces.try_emplace(body.surface.get(), surfaces.size());
    if (isNew) run["surfaces"].push_back(describe(*body.surface));
    run["bodies"].push_back(describe(body, place->second));
  }
  run["contacts"] = describeContacts(recording);
  run["steps"] = describeSteps(recording);
  return run;
}

void replaceAll(std::string& text, const std::string& old, const std::string& with) {
  for (std::size_t i = text.find(old); i != std::string::npos; i = text.find(old, i + with.size())) {
    text.replace(i, old.size(), with);
  }
}

/// No end tag and no comment may begin inside a script element, whatever bodies are called.
std::string inScript(const PageJson& json) {
  std::string text = json.dump(-1, ' ', true, PageJson::error_handler_t::replace);
  replaceAll(text, "<", "\\u003c");
  return text;
}

std::string inElement(std::string text) {
  replaceAll(text, "&", "&amp;");
  replaceAll(text, "<", "&lt;");
  return text;
}

}  // namespace

void writeHtmlPage(const std::string& path, const std::string& title, const Recording& recording) {
  std::string page;
  for (const char* const* part = kPageParts; *part != nullptr; ++part) page += *part;
  if (page.empty()) {
    throw std::runtime_error(path +
                             ": this program was built without three.js, which pages need (Debian: libjs-three)");
  }
  const std::string name = std::filesystem::path(title).filename().string();
  // The first mark of the title and the last one of the run are the page's own, whatever the texts have in them.
  const std::string titleMark = "%TITLE%", runMark = "%RUN%";
  page.replace(page.find(titleMark), titleMark.size(), inElement(name));
  page.replace(page.rfind(runMark), runMark.size(), inScript(describe(name, recording)));
  std::ofstream stream(path, std::ios::binary);
  if (!stream) throw std::runtime_error(path + ": cannot be written");
  stream << page;
  if (!stream.flush()) throw std::runtime_error(path + ": writing failed");
}

}  // namespace otg::scenes
