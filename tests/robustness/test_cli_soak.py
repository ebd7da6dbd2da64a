# SPDX-License-Identifier: BSD-3-Clause
"""otg soak: a minute of worlds, batches and questions, each answer twice; with a device where there is one."""
import cli_support
from cli_support import CliTest


class Soak(CliTest):
    def soak(self, *words):
        soak = self.run_json("soak", *words)["soak"]
        self.assertEqual(soak["differences"], 0, soak["first_difference"])
        self.assertGreaterEqual(soak["compared"], 2 * soak["rounds"])
        self.assertGreater(soak["queries"], 100 * soak["rounds"])
        return soak

    def test_answers_are_the_same_twice(self):
        soak = self.soak("--rounds", "250")
        self.assertEqual(soak["rounds"], 250)
        self.assertGreater(soak["worlds"], 60)

    def test_devices_come_go_and_fail(self):
        if self.run_json("devices")["used"] is None:
            self.skipTest("no OpenCL device")
        soak = self.soak("--rounds", "50", "--device")
        self.assertGreater(soak["devices_opened"], 0)
        self.assertGreater(soak["calls_failed"], 0)

    def test_rounds_depend_on_their_seeds_alone(self):
        first, second = (self.soak("--rounds", "20", "--seed", "7") for _ in range(2))
        for key in ("worlds", "steps", "queries", "compared"):
            self.assertEqual(first[key], second[key])

    def test_time_ends_it(self):
        self.assertGreater(self.soak("--hours", "0.0005")["rounds"], 0)


if __name__ == "__main__":
    cli_support.main()
