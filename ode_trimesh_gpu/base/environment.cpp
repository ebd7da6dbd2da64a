// SPDX-License-Identifier: BSD-3-Clause
#include "base/environment.h"

#include <algorithm>
#include <charconv>
#include <cstdlib>
#include <filesystem>
#include <limits>
#include <string_view>
#include <system_error>
#include <utility>

namespace otg {
namespace {

constexpr char kSwitch[] = "1, on, yes, true, 0, off, no, false";

/// Empty where there is none.
std::string valueOf(const char* name) {
  const char* const found = std::getenv(name);
  return found == nullptr ? std::string() : std::string(found);
}

class Reader {
 public:
  explicit Reader(std::vector<std::string>& faults) : faults_(faults) {}

  /// One of some words.
  template <class Choice, std::size_t kCount>
  std::optional<Choice> choice(const char* name, const std::pair<const char*, Choice> (&choices)[kCount],
                               const char* allowed) {
    const std::string value = valueOf(name);
    if (value.empty()) return std::nullopt;
    for (const auto& [word, meaning] : choices) {
      if (value == word) return meaning;
    }
    return fail<Choice>(name, value, allowed);
  }

  void flag(const char* name, bool& flag) {
    std::string value = valueOf(name);
    if (value.empty()) return;
    std::transform(value.begin(), value.end(), value.begin(),
                   [](char c) { return c >= 'A' && c <= 'Z' ? char(c + 32) : c; });
    const auto isOneOf = [&](std::initializer_list<const char*> words) {
      return std::any_of(words.begin(), words.end(), [&](const char* word) { return value == word; });
    };
    if (isOneOf({"1", "on", "yes", "true"})) {
      flag = true;
    } else if (isOneOf({"0", "off", "no", "false"})) {
      flag = false;
    } else {
      fail<bool>(name, valueOf(name), kSwitch);
    }
  }

  template <class Number>
  std::optional<Number> number(const char* name, Number least, Number most, const std::string& allowed) {
    const std::string value = valueOf(name);
    if (value.empty()) return std::nullopt;
    Number number = 0;
    const char* const end = value.data() + value.size();
    const auto [stop, error] = std::from_chars(value.data(), end, number);
    if (error == std::errc() && stop == end && number >= least && number <= most) return number;
    return fail<Number>(name, value, allowed);
  }

  /// Names with commas between them.
  std::vector<std::string> names(const char* name) {
    std::vector<std::string> found;
    const std::string value = valueOf(name);
    for (std::size_t at = 0; at < value.size();) {
      const std::size_t end = std::min(value.find(',', at), value.size());
      const std::string word = value.substr(at, end - at);
      const bool known = std::any_of(std::begin(kPreloadPrimitives), std::end(kPreloadPrimitives),
                                     [&](const char* primitive) { return word == primitive; });
      if (known) {
        found.push_back(word);
      } else if (!word.empty()) {
        std::string allowed;
        for (const char* const primitive : kPreloadPrimitives)
          allowed += std::string(allowed.empty() ? "" : ", ") + primitive;
        fail<int>(name, word, allowed + ", with commas between them");
      }
      at = end + 1;
    }
    return found;
  }

  std::string folder(const char* name) {
    std::string value = valueOf(name);
    std::error_code error;
    if (value.empty() || std::filesystem::is_directory(value, error)) return value;
    fail<int>(name, value, "a folder that is there");
    return {};
  }

 private:
  template <class T>
  std::optional<T> fail(const char* name, const std::string& value, const std::string& allowed) {
    faults_.push_back(environmentFault(name, value, allowed));
    return std::nullopt;
  }
  std::vector<std::string>& faults_;
};

std::string absolute(const char* name) {
  std::string value = valueOf(name);
  return std::filesystem::path(value).is_absolute() ? value : std::string();
}

}  // namespace

std::string environmentFault(const char* name, const std::string& value, const std::string& allowed) {
  std::string shown;
  for (const char c : value.substr(0, 80)) shown += c >= 32 && c < 127 ? c : '?';
  return std::string(name) + "=" + shown + " is not allowed and passed over; allowed: " + allowed;
}

Environment readEnvironment() {
  using Backend = Environment::Backend;
  using Contacts = Environment::Contacts;
  Environment e;
  Reader reader(e.faults);
  e.backend = reader.choice<Backend>("OTG_BACKEND",
                                     {{"auto", Backend::kAuto}, {"cpu", Backend::kCpu}, {"opencl", Backend::kOpencl}},
                                     "auto, cpu, opencl");
  e.deviceMemory = reader.number<std::uint64_t>("OTG_DEVICE_MEMORY", 0, std::numeric_limits<std::uint64_t>::max(),
                                                "a whole number of bytes, 0 for half of the device");
  e.threads = reader.number<unsigned>("OTG_THREADS", 1, kMostThreads, "1 to " + std::to_string(kMostThreads));
  e.openclDevice = valueOf("OTG_OPENCL_DEVICE");
  if (const char* const cache = std::getenv("OTG_CACHE_DIR"); cache != nullptr) e.cacheFolder = cache;
  std::error_code error;
  if (e.cacheFolder && std::filesystem::exists(*e.cacheFolder, error) &&
      !std::filesystem::is_directory(*e.cacheFolder, error)) {
    e.faults.push_back(
        environmentFault("OTG_CACHE_DIR", *e.cacheFolder, "a folder, or one that can be made, or nothing"));
    e.cacheFolder.reset();
  }
  e.kernelFolder = reader.folder("OTG_KERNEL_DIR");
  e.meshFolder = reader.folder("OTG_MESH_DIR");
  e.xdgCacheHome = absolute("XDG_CACHE_HOME");
  e.home = absolute("HOME");
  reader.flag("OTG_PRELOAD", e.preload);
  reader.flag("OTG_PRELOAD_JOIN", e.preloadJoin);
  reader.flag("OTG_PRELOAD_VERBOSE", e.preloadVerbose);
  e.preloadContacts = reader.choice<Contacts>(
      "OTG_PRELOAD_CONTACTS", {{"solid", Contacts::kSolid}, {"pairwise", Contacts::kPairwise}}, "solid, pairwise");
  e.preloadMaxContacts = reader.number<int>("OTG_PRELOAD_MAX_CONTACTS", 1, 65535, "1 to 65535");
  e.preloadContactsPerRegion = reader.number<int>("OTG_PRELOAD_CONTACTS_PER_REGION", 1, 64, "1 to 64");
  e.preloadPrimitives = reader.names("OTG_PRELOAD_PRIMITIVES");
  return e;
}

}  // namespace otg
