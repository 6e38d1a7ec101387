"""The Debian package is made, unpacked and run; it depends on what it is linked
with. Without dpkg there is nothing to test."""

import os
import re
import shutil
import subprocess
import unittest
from pathlib import Path

from common import HALVES, InScratch

BUILD = os.environ.get("NSFD_BUILD_DIR")


def output(*words, **options):
    return subprocess.run(
        words, check=True, capture_output=True, text=True, **options
    ).stdout


@unittest.skipUnless(BUILD and shutil.which("dpkg-shlibdeps"), "no build, or no dpkg")
class Debian(InScratch):
    def test_package(self):
        cpack = Path(shutil.which(os.environ.get("NSFD_CMAKE", "cmake"))).parent
        output(cpack / "cpack", "-B", self.scratch, cwd=BUILD)
        (package,) = self.scratch.glob("nsfd_*.deb")
        root = self.scratch / "root"
        output("dpkg-deb", "-x", package, root)
        program = root / "usr/bin/nsfd"
        self.assertRegex(output(program, "--version"), r"^nsfd \d+\.\d+\.\d+")

        # the folder of a package is not the checkout: nothing is taken from there
        scene = self.scratch / "halves.prm"
        scene.write_text(HALVES)
        output(program, scene, "--quiet", cwd=self.scratch)
        self.assertTrue((self.scratch / "output/halves/report.html").exists())
        for file in (
            "usr/include/nsfd/cohesive_laws/cohesive_law.h",
            "usr/lib/python3/dist-packages/nsfd/__init__.py",
            "usr/share/bash-completion/completions/nsfd",
            "usr/share/nsfd/prm/quickstart.prm",
        ):
            self.assertTrue((root / file).exists(), file)

        # every library that is linked belongs to a package that is a dependency
        depends = output("dpkg-deb", "-f", package, "Depends")
        named = set(re.findall(r"([a-z0-9][a-z0-9.+-]+)(?: \(|,|$)", depends))
        self.assertIn("openmpi-bin", named)
        needed = re.findall(r"NEEDED.*\[(.*)\]", output("readelf", "-d", program))
        paths = dict(re.findall(r"(\S+) => (\S+)", output("ldd", program)))
        self.assertGreater(len(needed), 10)
        places = {}
        for library in needed:
            if library not in paths:  # the loader
                continue
            real = os.path.realpath(paths[library])
            for place in (real, re.sub("^/usr", "", real)):
                places[place] = library
        # one call: what is nobody's (a library of its own build) is not printed
        lines = subprocess.run(
            ["dpkg", "-S", *places], capture_output=True, text=True
        ).stdout.splitlines()
        self.assertGreater(len(lines), 10)
        for line in lines:
            owner, place = line.split(":")[0], line.split(": ")[-1]
            # libopenblas provides what is called liblapack.so.3
            self.assertTrue({owner, places[place]} & named, f"{line} not in {depends}")

    def test_manual_page_and_completion(self):
        page = output("sh", Path(__file__).parents[2] / "source/package/manual_page.sh",
                      os.environ.get("NSFD", "nsfd"))
        for word in ("\\-\\-resume", "\\-\\-vary", "NSFD STUDY", "NSFD LAW"):
            self.assertIn(word, page)
        if shutil.which("man"):
            (self.scratch / "nsfd.1").write_text(page)
            text = output("man", "--warnings", "-l", self.scratch / "nsfd.1")
            self.assertIn("nonsmooth fracture dynamics", text)
        bash = (
            f"source {Path(__file__).parents[2]}/source/package/completion.bash\n"
            'COMP_WORDS=("$NSFD" law cama); COMP_CWORD=2; _nsfd; echo "${COMPREPLY[@]}"\n'
            'COMP_WORDS=("$NSFD" study --va); COMP_CWORD=2; _nsfd; echo "${COMPREPLY[@]}"\n'
        )
        found = output("bash", "-c", bash, cwd=self.scratch)
        self.assertEqual(found.split(), ["camacho-ortiz", "--vary"])


if __name__ == "__main__":
    unittest.main()
