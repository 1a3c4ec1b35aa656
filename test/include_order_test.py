#!/usr/bin/env python3
"""Headers are included in one direction only: from a folder to itself and to those before it in the table."""

import pathlib
import re
import unittest

ROOT = pathlib.Path(__file__).resolve().parent.parent
INCLUDE = re.compile(r'^\s*#include "([^"]+)"', re.MULTILINE)

# Folders of a package in the order of their dependencies. A folder includes from itself and from those before it.
OFFLINE_FOLDERS = ["support", "arithmetic", "lp", "program", "exact_kkt", "explore/sets", "explore/region",
                   "explore/state", "explore/parallel", "explore", "soft", "tree", "reduce", "verify", "certify",
                   "certify/reduction", "diff"]
CONTROLLER_FOLDERS = ["types", "realtime", "estimation", "reference", "laws", "flight", "parameters"]

# The folder that each public header of the offline solver belongs to.
OFFLINE_HEADERS = {
    "exact_lp": "lp",
    "partition": "program",
    "explore_options": "explore/sets", "process_group": "explore/parallel", "explore": "explore",
    "soft_bounds": "soft",
    "encode": "tree", "search_tree": "tree",
    "reduce": "reduce",
    "verify": "verify",
    "certify": "certify", "verify_reduction": "certify/reduction", "reduce_proven": "certify/reduction",
    "diff": "diff",
}

# What the production code below a path includes of other packages: prefixes of headers.
# Packages of ROS are not listed. The row of the deepest folder holds.
PACKAGES = {
    "region_maps/region_maps": {"polyfly_base", "region_maps"},
    "region_maps/polyfly_base": {"polyfly_base"},
    "region_maps/polyfly_base/command_line": {"polyfly_base", "command_line"},
    "region_maps/region_maps/export": {"polyfly_base", "region_maps", "map_export"},
    "region_maps/region_maps/plot": {"polyfly_base", "region_maps", "map_plot"},
    "region_maps/region_maps/explorer": {"polyfly_base", "region_maps", "map_explorer"},
    "online_controller/mpc_core": {"polyfly_base", "region_maps", "mpc_core"},
    "online_controller/polyfly_ros": {"polyfly_base", "polyfly_ros"},
    "online_controller/online_controller": {"polyfly_base", "region_maps", "mpc_core", "nonlinear_mpc", "online_controller"},
    "online_controller/online_controller/ros": {"polyfly_base", "polyfly_ros", "region_maps", "mpc_core", "nonlinear_mpc",
                              "online_controller", "online_controller_ros"},
    "offline_mpt": {"polyfly_base", "region_maps", "command_line", "map_plot", "map_export", "map_explorer", "mpc_core",
                    "offline_mpt", "polytope_sets", "robust_mpc", "safety_filter", "explorer_content", "export_proven"},
    "offline_mpt/src": {"polyfly_base", "region_maps", "mpc_core", "offline_mpt"},
    "offline_mpt/include": {"region_maps", "mpc_core", "offline_mpt"},
    "offline_mpt/checker": {"polyfly_base"},
    "offline_mpt/sets": {"polyfly_base", "region_maps", "mpc_core", "offline_mpt", "polytope_sets"},
    "offline_mpt/robust": {"polyfly_base", "region_maps", "mpc_core", "offline_mpt", "polytope_sets", "robust_mpc"},
    "offline_mpt/safety": {"polyfly_base", "region_maps", "mpc_core", "polytope_sets", "offline_mpt", "safety_filter"},
    "offline_mpt/explorer": {"polyfly_base", "region_maps", "map_explorer", "mpc_core", "robust_mpc",
                             "safety_filter", "explorer_content"},
    "offline_mpt/export": {"polyfly_base", "region_maps", "map_export", "mpc_core", "export_proven"},
    "fixedwing_lateral/fixedwing_lateral": {"polyfly_base", "command_line", "mpc_core", "fixedwing_lateral", "fixedwing_plant"},
    "fixedwing_lateral/fixedwing_lateral/ros": {"polyfly_base", "polyfly_ros", "fixedwing_lateral", "fixedwing_lateral_ros"},
    "calibration/bags": {"polyfly_base", "bags"},
    "calibration/report": {"polyfly_base", "map_plot", "bags", "report"},
    "calibration/identification": {"polyfly_base", "mpc_core", "bags", "report", "identification"},
    "calibration/autopilot": {"polyfly_base", "bags", "identification", "autopilot"},
    "calibration/excitation": {"polyfly_base", "online_controller", "excitation"},
    "calibration/excitation/ros": {"polyfly_base", "polyfly_ros", "online_controller", "online_controller_ros",
                                   "fixedwing_lateral_ros", "excitation", "excitation_ros"},
    "calibration/validation": {"polyfly_base", "region_maps", "map_plot", "mpc_core", "online_controller", "bags", "report",
                               "identification", "explorer_content", "validation"},
    "calibration/validation/ros": {"polyfly_base", "polyfly_ros", "command_line", "region_maps", "online_controller",
                                   "online_controller_ros", "bags", "report", "robust_mpc", "validation", "validation_ros"},
    "calibration/app": {"polyfly_base", "bags", "command_line", "mpc_core", "online_controller", "fixedwing_lateral",
                        "report", "identification", "autopilot"},
}
LIBRARIES = set.union(*PACKAGES.values())


def sources(path):
    """Production code below a path, relative to it."""
    for file in sorted((ROOT / path).rglob("*.[ch]pp")):
        relative = file.relative_to(ROOT / path)
        if not {"test", "fuzz", "bench"} & set(relative.parts):
            yield relative.as_posix(), INCLUDE.findall(file.read_text(encoding="utf-8"))


def innermost(path, folders):
    """The deepest of `folders` that holds a path; None where none does."""
    return max((folder for folder in folders if path.startswith(folder + "/")), key=len, default=None)


def against_order(path, folders, folder_of):
    """What is wrong in the files below `path`; `folder_of` tells the folder of an included header, None: another's."""
    wrong = []
    for file, names in sources(path):
        here = innermost(file, folders)
        if here is None:
            wrong.append(f"{path}/{file} lies in no folder of the table")
            continue
        for name in names:
            there = folder_of(name)
            if there is not None and folders.index(there) > folders.index(here):
                wrong.append(f"{path}/{file} includes {name} of '{there}', which comes after '{here}'")
    return wrong


class IncludeOrder(unittest.TestCase):
    def test_folders_of_the_offline_solver(self):
        def folder_of(name):
            if name.startswith("offline_mpt/"):
                return OFFLINE_HEADERS[name.split("/")[1].rsplit(".", 1)[0]]
            return innermost(name, OFFLINE_FOLDERS)

        self.assertEqual([], against_order("offline_mpt/src", OFFLINE_FOLDERS, folder_of))

    def test_folders_of_the_online_controller(self):
        def folder_of(name):
            package, _, rest = name.partition("/")
            return innermost(rest, CONTROLLER_FOLDERS) if package == "online_controller" else None

        for kind in ("include", "src"):
            path = f"online_controller/online_controller/{kind}/online_controller"
            self.assertEqual([], against_order(path, CONTROLLER_FOLDERS, folder_of))

    def test_packages(self):
        wrong = []
        for path in PACKAGES:
            for file, names in sources(path):
                allowed = PACKAGES[innermost(f"{path}/{file}", PACKAGES)]
                wrong += [f"{path}/{file} includes {name}" for name in names
                          if name.split("/")[0] in LIBRARIES - allowed and "/" in name]
        self.assertEqual([], wrong)


if __name__ == "__main__":
    unittest.main(verbosity=2)
