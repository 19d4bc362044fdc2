"""OpenCV's side of opencv.rs.

make DIR       writes calibrations by FileStorage, and what cv2 projects by them, into DIR
project FILE   projects by the cameras of a file that phalanx-io wrote
"""

import sys
import tomllib
from pathlib import Path

import cv2
import numpy as np

LENSES = {"brown": 5, "rational": 8, "prism": 12, "tilted": 14, "fisheye": 4}
# How large coefficients are: k1 k2 p1 p2 k3 k4 k5 k6 s1 s2 s3 s4 tau_x tau_y.
SCALES = [0.15, 0.05, 2e-3, 2e-3, 0.02, 0.1, 0.03, 0.01, 2e-3, 1e-3, 2e-3, 1e-3, 0.02, 0.02]
CAMERAS = ["a", "b", "c"]


def points(random):
    return random.uniform(-150, 150, (40, 3))


def project(lens, points, camera):
    matrix, dist, rvec, tvec = camera
    module = cv2.fisheye if lens == "fisheye" else cv2
    if lens == "fisheye":
        pixels, _ = module.projectPoints(points.reshape(-1, 1, 3), rvec, tvec, matrix, dist)
    else:
        pixels, _ = module.projectPoints(points, rvec, tvec, matrix, dist)
    return pixels.reshape(-1, 2)


def camera(lens, random, index):
    focal = random.uniform(500, 1500)
    matrix = np.array([[focal, 0, random.uniform(600, 680)],
                       [0, focal * random.uniform(0.99, 1.01), random.uniform(330, 390)], [0, 0, 1]])
    dist = random.uniform(-1, 1, LENSES[lens]) * SCALES[:LENSES[lens]]
    rvec = random.normal(size=3) * 1.2
    tvec = np.array([random.uniform(-30, 30), random.uniform(-30, 30), 600.0 + 150 * index])
    return matrix, dist, rvec, tvec


def make(folder):
    random = np.random.default_rng(7)
    for lens in LENSES:
        cameras = {name: camera(lens, random, i) for i, name in enumerate(CAMERAS)}
        for ending in ["yml", "xml", "json"]:
            storage = cv2.FileStorage(str(folder / f"{lens}.{ending}"), cv2.FILE_STORAGE_WRITE)
            storage.startWriteStruct("names", cv2.FileNode_SEQ)
            for name in CAMERAS:
                storage.write("", name)
            storage.endWriteStruct()
            for name, (matrix, dist, rvec, tvec) in cameras.items():
                storage.write(f"K_{name}", matrix)
                storage.write(f"dist_{name}", dist)
                storage.write(f"R_{name}", rvec)
                storage.write(f"T_{name}", tvec)
                storage.write(f"W_{name}", 1280)
                storage.write(f"H_{name}", 720)
                if lens == "fisheye":
                    storage.write(f"fisheye_{name}", 1)
            storage.release()
        with open(folder / f"{lens}.txt", "w") as expected:
            for name, of in cameras.items():
                world = points(random)
                for point, pixel in zip(world, project(lens, world, of)):
                    print(name, *map(repr, map(float, [*point, *pixel])), file=expected)


def read(path):
    """Names and (lens, camera) of a file that phalanx-io wrote."""
    if path.suffix == ".toml":
        for key, section in tomllib.loads(path.read_text()).items():
            if key != "metadata":
                lens = "fisheye" if section.get("fisheye") else "brown"
                numbers = [np.array(section[k]) for k in ["matrix", "distortions", "rotation", "translation"]]
                yield section["name"], (lens, numbers)
    else:
        storage = cv2.FileStorage(str(path), cv2.FILE_STORAGE_READ)
        names = storage.getNode("names")
        for name in [names.at(i).string() for i in range(names.size())]:
            lens = "brown" if storage.getNode(f"fisheye_{name}").empty() else "fisheye"
            yield name, (lens, [storage.getNode(f"{k}_{name}").mat() for k in ["K", "dist", "R", "T"]])


def project_file(path):
    world = points(np.random.default_rng(8))
    for name, (lens, numbers) in read(path):
        for point, pixel in zip(world, project(lens, world, numbers)):
            print(name, *map(repr, map(float, [*point, *pixel])))


mode, path = sys.argv[1:]
{"make": make, "project": project_file}[mode](Path(path))
