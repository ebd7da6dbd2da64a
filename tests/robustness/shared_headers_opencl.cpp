// SPDX-License-Identifier: BSD-3-Clause
// Every header of kernels/shared compiles as OpenCL C 1.2 without a warning, alone and together with all others. In
// float and, where the device has doubles, in double. Compiles only: what the formulas compute is the business of other
// tests.
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <exception>
#include <filesystem>
#include <iostream>
#include <string>
#include <vector>

#define CL_HPP_ENABLE_EXCEPTIONS
#define CL_HPP_TARGET_OPENCL_VERSION 120
#define CL_HPP_MINIMUM_OPENCL_VERSION 120
#include <CL/opencl.hpp>

namespace {

constexpr int kSkipped = 77;  // ctest reports a test that exits with this as skipped

std::vector<cl::Device> allDevices() {
  std::vector<cl::Device> devices;
  std::vector<cl::Platform> platforms;
  try {
    cl::Platform::get(&platforms);
    for (const cl::Platform& platform : platforms) {
      std::vector<cl::Device> found;
      platform.getDevices(CL_DEVICE_TYPE_ALL, &found);
      devices.insert(devices.end(), found.begin(), found.end());
    }
  } catch (const cl::Error& error) {
    if (error.err() != -1001 /* no platform */ && error.err() != CL_DEVICE_NOT_FOUND) throw;
  }
  return devices;
}

/// The headers that a program includes, as FOLDER/NAME.h and in alphabetical order; generic_begin.h and generic_end.h
/// are brackets for others.
std::vector<std::string> sharedHeaders() {
  std::vector<std::string> names;
  const std::filesystem::path root = OTG_KERNEL_DIR "/shared";
  for (const auto& entry : std::filesystem::recursive_directory_iterator(root)) {
    const std::filesystem::path& path = entry.path();
    const bool bracket = path.filename().string().rfind("generic_", 0) == 0;
    if (path.extension() == ".h" && !bracket) names.push_back(path.lexically_relative(root).generic_string());
  }
  std::sort(names.begin(), names.end());
  return names;
}

std::string source(const std::vector<std::string>& headers, bool doubles) {
  std::string text;
  for (const std::string precision : {"FLOAT", "DOUBLE"}) {
    if (precision == "DOUBLE" && !doubles) break;
    text += "#define OTG_REAL_" + precision + "\n";
    for (const std::string& header : headers) text += "#include \"shared/" + header + "\"\n";
    text += "#undef OTG_REAL_" + precision + "\n";
  }
  return text + "__kernel void probe(__global int* out) { out[get_global_id(0)] = 1; }\n";
}

/// The build log; empty if the program builds without a warning.
std::string buildLog(const cl::Device& device, const std::string& text) {
  cl::Program program(cl::Context(device), text);
  std::string verdict;
  try {
    program.build({device}, "-cl-std=CL1.2 -Werror -I " OTG_KERNEL_DIR);
  } catch (const cl::Error& error) {
    verdict = std::string(error.what()) + " failed with " + std::to_string(error.err()) + "\n";
  }
  return verdict.empty() ? verdict : verdict + program.getBuildInfo<CL_PROGRAM_BUILD_LOG>(device);
}

/// Counts and prints what is wrong.
class Report {
 public:
  void expect(bool good, const std::string& what, const std::string& log = {}) {
    ++checks_;
    if (good) return;
    ++failures_;
    std::cout << "FAILED: " << what << "\n" << log << "\n";
  }
  int finish() const {
    std::cout << checks_ << " programs compiled, " << failures_ << " not as expected\n";
    return failures_ == 0 && checks_ > 0 ? 0 : 1;
  }

 private:
  int checks_ = 0;
  int failures_ = 0;
};

void compileAll(const cl::Device& device, std::vector<std::string> headers, Report& report) {
  const std::string name = device.getInfo<CL_DEVICE_NAME>() + ": ";
  const bool doubles = device.getInfo<CL_DEVICE_DOUBLE_FP_CONFIG>() != 0;
  for (const std::string& header : headers) {
    std::string log = buildLog(device, source({header}, false));
    report.expect(log.empty(), name + header + " alone in float", log);
    if (!doubles) continue;
    log = buildLog(device, source({header}, true));
    report.expect(log.empty(), name + header + " alone in float and double", log);
  }
  std::string log = buildLog(device, source(headers, doubles));
  report.expect(log.empty(), name + "all headers together", log);
  std::reverse(headers.begin(), headers.end());
  log = buildLog(device, source(headers, doubles));
  report.expect(log.empty(), name + "all headers together, in reverse order", log);

  // A compiler that accepts anything would let all of the above pass.
  report.expect(!buildLog(device, source({"no_such_header.h"}, false)).empty(), name + "a missing header is an error");
  report.expect(!buildLog(device, "inline static int f(void) { int unused; return 1 }\n").empty(),
                name + "a syntax error is an error");
}

/// Drivers have been seen to end the process while they look for devices (PoCL where /sys is not mounted). That is no
/// fault of the headers, and is found out in a process that may end.
bool driverSurvivesListing() {
  const pid_t child = fork();
  if (child == 0) {
    try {
      allDevices();
    } catch (const cl::Error&) {  // main() meets it again and reports it
    }
    _exit(0);
  }
  int status = 0;
  return child > 0 && waitpid(child, &status, 0) == child && WIFEXITED(status);
}

}  // namespace

int main() {
  if (!driverSurvivesListing()) {
    std::cout << "skipped: the OpenCL driver ended the process that asked for its devices\n";
    return kSkipped;
  }
  try {
    const std::vector<cl::Device> devices = allDevices();
    if (devices.empty()) {
      std::cout << "skipped: no OpenCL device (Debian: pocl-opencl-icd)\n";
      return kSkipped;
    }
    Report report;
    const std::vector<std::string> headers = sharedHeaders();
    for (const cl::Device& device : devices) compileAll(device, headers, report);
    return report.finish();
  } catch (const std::exception& error) {
    std::cout << "FAILED: " << error.what() << "\n";
    return 1;
  }
}
