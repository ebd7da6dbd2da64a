// SPDX-License-Identifier: BSD-3-Clause
// A fuzz target without libFuzzer: its seeds, and thousands of random changes of them.
//
//   replay_TARGET            runs them
//   replay_TARGET FOLDER     writes the seeds there, for libFuzzer to begin with
#include <cstdio>
#include <fstream>
#include <random>
#include <string>

#include "fuzz/fuzz_target.h"

using otg::fuzz::Input;

namespace {

Input changed(Input input, std::mt19937& random) {
  for (unsigned left = 1 + random() % 4; left > 0 && !input.empty(); --left) {
    const std::size_t at = random() % input.size();
    switch (random() % 4) {
      case 0:
        input[at] = static_cast<std::uint8_t>(random());
        break;
      case 1:
        input[at] ^= static_cast<std::uint8_t>(1u << random() % 8);
        break;
      case 2:
        input.resize(at);
        break;
      default:
        input.insert(input.begin() + static_cast<std::ptrdiff_t>(at), input[random() % input.size()]);
    }
  }
  return input;
}

}  // namespace

int main(int argc, char** argv) {
  const std::vector<Input> seeds = otg::fuzz::seeds();
  if (argc > 1) {
    for (std::size_t i = 0; i < seeds.size(); ++i) {
      std::ofstream out(std::string(argv[1]) + "/seed_" + std::to_string(i), std::ios::binary);
      out.write(reinterpret_cast<const char*>(seeds[i].data()), static_cast<std::streamsize>(seeds[i].size()));
      if (!out) return 1;
    }
    return 0;
  }
  std::mt19937 random(1);
  for (const Input& seed : seeds) {
    LLVMFuzzerTestOneInput(seed.data(), seed.size());
    for (int round = 0; round < 200; ++round) {
      const Input input = changed(seed, random);
      LLVMFuzzerTestOneInput(input.data(), input.size());
    }
  }
  std::printf("%zu seeds, each with 200 changes\n", seeds.size());
  return 0;
}
