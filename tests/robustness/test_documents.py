# SPDX-License-Identifier: BSD-3-Clause
"""Pages stay true: those of concepts hold no measured tables and no commits, results are written by the script, trials
are dated, links lead somewhere, and sources use the words of the field. Run as: python3 test_documents.py"""
import pathlib
import re
import unittest

import comment_sentences

ROOT = pathlib.Path(__file__).resolve().parents[2]
CONCEPTS = sorted([ROOT / "README.md", *ROOT.glob("docs/*.md")])
RESULTS = sorted(ROOT.glob("docs/results/*.md"))
LAB = sorted(ROOT.glob("docs/lab/*.md"))
# Seven, ten or sixteen digits of a hash: not a number, not a word.
HASH = re.compile(r"(?<![\w.#-])(?=[0-9a-f]*[a-f])(?=[0-9a-f]*[0-9])"
                  r"(?:[0-9a-f]{7}|[0-9a-f]{10}|[0-9a-f]{16})(?![\w.-])")
NUMBER = re.compile(r"[-+~<>≤≥]*\d[\d,.e+-]*( ?/ ?[\d,.e+-]+)*\s?%?")


def numbers_in(line):
    return sum(bool(NUMBER.fullmatch(cell.strip())) for cell in line.strip().strip("|").split("|"))


def anchors_of(page):
    """As GitHub makes them of headings."""
    anchors, fenced = set(), False
    for line in page.read_text().splitlines():
        fenced ^= line.startswith("```")
        if line.startswith("#") and not fenced:
            text = re.sub(r"[^\w\- ]", "", line.lstrip("#").strip().lower())
            anchors.add(text.replace(" ", "-"))
    return anchors


def sentences_of(page):
    """Of prose and lists; not of tables, headings and blocks of code."""
    text = re.sub(r"(?m)^(    .*|\|.*|#.*)$", "", re.sub(r"```.*?```", "", page.read_text(), flags=re.S))
    text = re.sub(r"!?\[([^\]]*)\]\([^)]*\)", r"\1", text)
    for block in re.split(r"\n\s*\n|\n(?=\s*[-*] |\s*\d+\. )", text):
        for sentence in re.split(r"(?<=[.!?:;])\s+", block):
            if sentence.strip():
                yield " ".join(sentence.split())


class Documents(unittest.TestCase):
    def test_concepts_hold_no_numbers_of_a_run(self):
        self.assertGreater(len(CONCEPTS), 8)
        for page in CONCEPTS:
            for number, line in enumerate(page.read_text().splitlines(), 1):
                with self.subTest(place="%s:%d" % (page.relative_to(ROOT), number)):
                    self.assertIsNone(HASH.search(line), "a commit or a hash of an answer belongs to results or lab")
                    if line.startswith("|"):
                        self.assertLess(numbers_in(line), 3, "a measured table belongs to docs/results")

    def test_results_are_written_by_the_script(self):
        self.assertTrue((ROOT / "docs/results/counts.md").is_file())
        index = (ROOT / "docs/results/README.md").read_text()
        for page in RESULTS:
            if page.name == "README.md":
                continue
            text = page.read_text()
            with self.subTest(page=page.name):
                self.assertIn("(%s)" % page.name, index)
                self.assertIn("Written by `scripts/results.sh`", text)
                self.assertRegex(text, r"(?m)^    .*build/bin/otg bench ")
                self.assertRegex(text, r"(?m)^(Measured \d{4}-\d\d-\d\d at commit [0-9a-f]{7,} on .+"
                                       r"|Holds on every machine)\.$")
                self.assertNotIn("DIFFERENT", text, "an answer is not the CPU's")

    def test_trials_are_dated(self):
        index = (ROOT / "docs/lab/README.md").read_text()
        for page in LAB:
            if page.name != "README.md":
                self.assertRegex(page.name, r"^\d{4}-\d\d-[a-z_]+\.md$")
                self.assertIn("(%s)" % page.name, index)

    def test_links_lead_somewhere(self):
        seen = 0
        for page in [*CONCEPTS, *RESULTS, *LAB]:
            text = re.sub(r"```.*?```", "", page.read_text(), flags=re.S)
            for link in re.findall(r"\]\(([^)\s]+)\)", text):
                if re.match(r"[a-z]+:", link):
                    continue
                path, _, anchor = link.partition("#")
                target = (page.parent / path).resolve() if path else page
                with self.subTest(page=str(page.relative_to(ROOT)), link=link):
                    self.assertTrue(target.exists(), "leads nowhere")
                    if anchor:
                        self.assertIn(anchor, anchors_of(target))
                seen += 1
        self.assertGreater(seen, 80)

    def test_readme_is_read_in_a_hurry(self):
        text = (ROOT / "README.md").read_text()
        prose = re.sub(r"(?m)^    .*$", "", re.sub(r"```.*?```", "", text, flags=re.S))
        prose = re.sub(r"!?\[([^\]]*)\]\([^)]*\)", r"\1", prose)
        pieces = []
        for block in re.split(r"\n\s*\n|\n(?=[-#|]|\d\. )", prose):
            parts = block.strip("|").split("|") if block.startswith("|") else re.split(r"(?<=[.!?])\s+", block)
            pieces += [" ".join(part.split()) for part in parts]
        self.assertGreater(len(pieces), 60)
        for piece in pieces:
            self.assertLessEqual(len(piece.split()), 25, piece)

    def test_sentences_are_short_and_in_the_fields_words(self):
        private = re.compile(r"\b(wish(es)?|in vain|sooner done|asks the processor|(is|are|be|was|were) told)\b", re.I)
        checked = 0
        for page in CONCEPTS:
            lengths = [len(sentence.split()) for sentence in sentences_of(page) if len(sentence.split()) > 3]
            with self.subTest(page=page.name):
                self.assertLessEqual(sum(lengths), len(lengths) * 15)
                for sentence in sentences_of(page):
                    self.assertLessEqual(len(sentence.split()), 25, sentence)
                    checked += 1
                for number, line in enumerate(page.read_text().splitlines(), 1):
                    self.assertNotRegex(line, private, "line %d" % number)
        self.assertGreater(checked, 1500)

    def test_sources_are_in_the_fields_words(self):
        private = re.compile(r"wish|\bin vain\b|\bsooner done\b|\basks the processor\b|(?<!fore)told|\bfor want of\b",
                             re.I)
        folders = ("ode_trimesh_gpu", "kernels", "harness", "benchmarks", "demos", "python", "examples", "tests",
                   "scripts", "cmake")
        checked = 0
        for page in (file for folder in folders for file in (ROOT / folder).rglob("*")):
            if page.suffix not in (".h", ".hpp", ".cpp", ".c", ".cl", ".py", ".sh", ".cmake"):
                continue
            if page.name == "test_documents.py":
                continue
            checked += 1
            found = private.search(page.read_text())
            with self.subTest(page=str(page.relative_to(ROOT))):
                self.assertIsNone(found, found and found.group(0))
        self.assertGreater(checked, 700)

    def test_sentences_of_comments_are_short(self):
        example = "int a;  // one two. Three\n\n/* Four\n * five. */\n// |six|\n// seven x^2 eight\n"
        found = [sentence for _, sentence in comment_sentences.sentences(example) if sentence]
        self.assertEqual(found, ["one two.", "Three", "Four five.", "seven x^2 eight"])
        self.assertEqual(comment_sentences.word_count(found[-1]), 2)
        checked = 0
        for folder in ("ode_trimesh_gpu", "kernels", "harness", "benchmarks", "demos", "python", "examples", "tests"):
            for page in (ROOT / folder).rglob("*"):
                if page.suffix not in (".h", ".hpp", ".cpp", ".c", ".cl"):
                    continue
                for line, sentence in comment_sentences.sentences(page.read_text()):
                    checked += 1
                    self.assertLessEqual(comment_sentences.word_count(sentence), 25,
                                         "%s:%d: %s" % (page.relative_to(ROOT), line, sentence))
        self.assertGreater(checked, 10000)

    def test_the_first_program_is_the_same_everywhere(self):
        blocks = [re.search(r"```c\n(.*?)```", (ROOT / name).read_text(), re.S).group(1)
                  for name in ("README.md", "docs/getting_started.md")]
        self.assertIn("dCreateGpuTriMesh", blocks[0])  # robustness.installed_package compiles it
        self.assertEqual(*blocks)


if __name__ == "__main__":
    unittest.main()
