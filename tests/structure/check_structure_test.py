"""Tests of check_structure.py on small trees with one fault each."""

import pathlib
import tempfile
import unittest

import check_structure


class Findings(unittest.TestCase):
    def findings(self, check, files):
        with tempfile.TemporaryDirectory() as folder:
            root = pathlib.Path(folder)
            for name, text in {"CMakeLists.txt": "", **files}.items():
                (root / name).parent.mkdir(parents=True, exist_ok=True)
                (root / name).write_text(text, encoding="utf-8")
            return list(check(root))

    def arrows(self, files):
        return self.findings(check_structure.find_wrong_arrows, files)

    def test_allowed_arrows(self):
        self.assertEqual(self.arrows({
            "pipeline/a.cpp": '#include "raster/a.h"\n#include <core/b.h>\n#include <glm/glm.hpp>\n',
            "tests/a.cpp": '#include "cli/a.h"\n',
        }), [])

    def test_arrow_back(self):
        self.assertEqual(self.arrows({"raster/a.h": '\n#include "mesh/mesh.h"\n'}),
                         ["raster/a.h:2: raster must not know mesh"])

    def test_siblings_do_not_know_each_other(self):
        self.assertEqual(len(self.arrows({"grouping/a.h": '#  include <scenes/scene.h>\n'})), 1)

    def test_nobody_knows_the_tests(self):
        self.assertEqual(len(self.arrows({"cli/a.cpp": '#include "tests/a.h"\n'})), 1)

    def test_include_from_the_own_folder(self):
        self.assertEqual(len(self.arrows({"mesh/a.h": "", "mesh/b.h": '#include "a.h"\n'})), 1)
        self.assertEqual(len(self.arrows({"mesh/b.h": '#include "../core/a.h"\n'})), 1)

    def test_long_lines(self):
        found = self.findings(check_structure.find_long_lines,
                              {"core/a.h": "x" * 120 + "\n" + "x" * 121 + "\n", "scripts/run": "y" * 121})
        self.assertEqual(found, [
            "core/a.h:2: 121 characters, at most 120",
            "scripts/run:1: 121 characters, at most 120",
        ])

    def test_citations(self):
        found = self.findings(check_structure.find_unknown_citations, {
            "docs/references.md": "- **[AB12]** A, B.\n",
            "core/a.h": "x[1];  // [AB12]\n/// [AB12] and [CD34] eq. 2\nkeys[AB99] = 0;\n",
        })
        self.assertEqual(found, ["core/a.h:2: [CD34] is not in docs/references.md"])


if __name__ == "__main__":
    unittest.main()
