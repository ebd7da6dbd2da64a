// SPDX-License-Identifier: BSD-3-Clause
// `otg devices`: OpenCL devices, and which one would be used.
#include <fmt/format.h>

#include "base/environment.h"
#include "cli/query_options.h"
#include "opencl/runtime/device_info.h"
#include "otg/commands.h"

namespace otg::cli {
namespace {

int runDevices(bool json) {
  const std::vector<opencl::DeviceInfo> devices = findDevices();
  const int used = opencl::defaultDevice(devices);
  Json rows = Json::array();
  for (const opencl::DeviceInfo& d : devices) {
    rows.push_back({{"index", d.index},
                    {"name", d.name},
                    {"kind", opencl::nameOf(d.kind)},
                    {"platform", d.platform},
                    {"vendor", d.vendor},
                    {"version", d.version},
                    {"driver", d.driver},
                    {"available", d.available},
                    {"doubles", d.doubles},
                    {"compute_units", d.computeUnits},
                    {"global_memory", d.globalMemory},
                    {"local_memory", d.localMemory},
                    {"largest_work_group", d.largestWorkGroup},
                    {"used", d.index == used}});
  }
  if (json) {
    printJson({{"devices", rows}, {"used", used < 0 ? Json() : Json(used)}});
    return kOk;
  }
  if (devices.empty()) {
    fmt::print(
        "no OpenCL device: everything runs on the CPU\n"
        "(a device needs its vendor's OpenCL driver; pocl-opencl-icd makes the CPU one)\n");
    return kOk;
  }
  std::vector<std::vector<std::string>> table;
  table.reserve(devices.size());
  for (const opencl::DeviceInfo& d : devices) {
    table.push_back({std::to_string(d.index), d.index == used ? "default" : "", d.name, opencl::nameOf(d.kind),
                     std::to_string(d.computeUnits),
                     fmt::format("{:.1f} GiB", static_cast<double>(d.globalMemory) / (1 << 30)),
                     d.doubles ? "yes" : "no", d.available ? d.platform : d.platform + " (not available)"});
  }
  printTable({"device", "", "name", "kind", "compute units", "memory", "doubles", "platform"}, table);
  if (used >= 0) {
    fmt::print(
        "\n--backend opencl uses device {} unless --device names others; OTG_OPENCL_DEVICE=NUMBER|NAME|none changes "
        "the default.\n",
        used);
  } else {
    fmt::print("\nNone of them is used{}.\n",
               !readEnvironment().openclDevice.empty() ? ": OTG_OPENCL_DEVICE says so or names none of them" : "");
  }
  return kOk;
}

}  // namespace

void addDevicesCommand(CLI::App& app, Action& action) {
  CLI::App* command = app.add_subcommand("devices", "OpenCL platforms and devices, and which one would be used");
  auto json = std::make_shared<bool>(false);
  command->add_flag("--json", *json, "One JSON document on stdout");
  command->callback([json, &action] { action = [json] { return runDevices(*json); }; });
}

}  // namespace otg::cli
