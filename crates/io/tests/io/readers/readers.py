"""readers.py FOLDER: reads a take in every format with other tools' readers and compares values.

The JSON Lines, which are validated against the published schema first, say what is expected.
"""

import json
import sys
from pathlib import Path

import numpy as np

folder = Path(sys.argv[1])
lines = [json.loads(line) for line in (folder / "take.jsonl").read_text().splitlines()]
header, frames = lines[0], lines[1:]
NOTHING = float("nan")
dofs = list(frames[0]["pose"])
joints = list(frames[0]["joints_mm"])
times = np.array([frame["time"] for frame in frames])


def table(key, names, empty):
    """The same of every frame, NaN where there is none."""
    rows = []
    for frame in frames:
        values = frame[key] or {}
        rows.append([empty if values.get(name) is None else values[name] for name in names])
    return np.array(rows, dtype=float)


poses = table("pose", dofs, NOTHING)
stds = table("std", dofs, NOTHING)
points = table("joints_mm", joints, [NOTHING] * 3)
point_stds = table("joints_std_mm", joints, [NOTHING] * 3)
found = ~np.isnan(poses[:, 0])
assert found.sum() == len(frames) - 1


def same(read, expected, tolerance=1.01e-4):
    np.testing.assert_allclose(read, expected, rtol=0, atol=tolerance, equal_nan=True)


def check_schema():
    import jsonschema

    schema = json.loads((folder / "schema.json").read_text())
    jsonschema.Draft202012Validator.check_schema(schema)
    validator = jsonschema.Draft202012Validator(schema)
    for line in lines:
        validator.validate(line)
    broken = json.loads(json.dumps(frames[0]))
    broken["pose"]["index.knee"] = 1
    assert not validator.is_valid(broken) and not validator.is_valid({**header, "version": 9})


def check_csv():
    import pandas

    read = pandas.read_csv(folder / "take.csv")
    same(read[dofs], poses)
    same(read[[f"{name}_std" for name in dofs]], stds)
    same(read[[f"{name}_{axis}" for name in joints for axis in "xyz"]], points.reshape(len(frames), -1))
    same(read["time"], times, 1e-6)
    assert read["doubts"][5] == "few-views;low-overlap" and pandas.isna(read["doubts"][0])
    assert read["left_out"][7] == "top:disagrees" and pandas.isna(read["left_out"][5])
    assert json.loads(read["take"][0]) == header


def check_npz():
    read = np.load(folder / "take.npz", allow_pickle=False)
    assert list(read["dof_names"]) == dofs and list(read["joint_names"]) == joints
    same(read["pose"], poses)
    same(read["pose_std"], stds)
    same(read["joints"], points)
    same(read["joints_std"], point_stds)
    same(read["time"], times, 1e-6)
    assert (read["found"] == found).all() and read["frame"].tolist() == [f["frame"] for f in frames]
    doubted = [list(read["doubt_codes"][row]) for row in read["doubted"]]
    assert doubted == [frame["doubts"] for frame in frames]
    assert read["left_out"].tolist() == [[v["left_out"] or "" for v in frame["views"]] for frame in frames]
    assert json.loads(str(read["header"])) == header


def check_trc():
    import opensim

    read = opensim.TimeSeriesTableVec3(str(folder / "take.trc"))
    assert list(read.getColumnLabels()) == joints and read.getTableMetaDataString("Units") == "m"
    same(list(read.getIndependentColumn()), times, 1e-6)
    # The world's Z is the file's Y.
    expected = np.stack([points[..., 0], points[..., 2], -points[..., 1]], -1) / 1000
    # Each of these is a view into the one before, which must outlive it.
    flat = read.flatten()
    matrix = flat.getMatrix()
    values = matrix.to_numpy().copy()
    same(values.reshape(expected.shape), expected, 1.1e-6)


def check_motion():
    import opensim

    def read(name):
        table = opensim.TimeSeriesTable(str(folder / name))
        assert table.getTableMetaDataString("inDegrees") == "yes"
        same(list(table.getIndependentColumn()), times[found], 1e-6)
        # The reader of OpenSim's older tools, which stops at a cell that it cannot read.
        assert opensim.Storage(str(folder / name)).getSize() == found.sum()
        matrix = table.getMatrix()
        return list(table.getColumnLabels()), matrix.to_numpy().copy()

    labels, values = read("phalanx.mot")
    assert labels == dofs
    same(values, poses[found])
    labels, values = read("phalanx_std.sto")
    assert labels == [name for name in dofs if name != "global.theta_x"], "it has no deviation"
    same(values, stds[found][:, [dofs.index(name) for name in labels]])
    # What each model calls the numbers, written down anew: names by finger, with its number.
    fingers = {"index": 2, "middle": 3, "ring": 4, "little": 5}
    known = {
        "opensim": ({"mcp": "{}mcp_flexion", "pip": "{}pm_flexion", "dip": "{}md_flexion", "abduction": "{}mcp_abduction"}, 1),
        "myohand": ({"mcp": "mcp{}_flexion", "pip": "pm{}_flexion", "dip": "md{}_flexion", "abduction": "mcp{}_abduction"}, -1),
    }
    for model, (of_finger, ip_sign) in known.items():
        expected = {
            pattern.format(number): (f"{finger}.{joint}", 1)
            for finger, number in fingers.items()
            for joint, pattern in of_finger.items()
        }
        expected |= {
            "flexion": ("wrist.flexion", 1),
            "deviation": ("wrist.deviation", -1),
            "cmc_abduction": ("thumb.abduction", 1),
            "cmc_flexion": ("thumb.cmc", 1),
            "mp_flexion": ("thumb.mcp", 1),
            "ip_flexion": ("thumb.ip", ip_sign),
        }
        labels, values = read(f"{model}.mot")
        std_labels, std_values = read(f"{model}_std.sto")
        assert set(labels) == set(std_labels) == set(expected) and len(labels) == len(expected)
        for name, (dof, sign) in expected.items():
            same(values[:, labels.index(name)], sign * poses[found][:, dofs.index(dof)])
            same(std_values[:, std_labels.index(name)], stds[found][:, dofs.index(dof)])


def check_c3d():
    import ezc3d

    read = ezc3d.c3d(str(folder / "take.c3d"))
    assert read["parameters"]["POINT"]["LABELS"]["value"] == joints
    assert read["parameters"]["POINT"]["UNITS"]["value"] == ["mm"]
    assert read["parameters"]["POINT"]["RATE"]["value"][0] == header["rate_hz"]
    values = np.moveaxis(read["data"]["points"][:3], 0, -1).swapaxes(0, 1)
    same(values[found], points[found], 2e-4)
    residuals = read["data"]["meta_points"]["residuals"][0].T
    assert (residuals[found] == 0).all()
    assert (residuals[~found] == -1).all()


def turn(axis, degrees):
    """A rotation about X, Y or Z."""
    c, s = np.cos(np.radians(degrees)), np.sin(np.radians(degrees))
    i, j = [(1, 2), (2, 0), (0, 1)]["XYZ".index(axis)]
    matrix = np.eye(3)
    matrix[i, i] = matrix[j, j] = c
    matrix[i, j], matrix[j, i] = -s, s
    return matrix


def check_bvh():
    from bvh import Bvh

    read = Bvh((folder / "take.bvh").read_text())
    same(read.frame_time, 1 / header["rate_hz"], 1e-6)
    names = read.get_joints_names()

    def place(name, frame):
        """The frame of a bone: place and rotation, from the root down."""
        parent = read.joint_parent(name)
        offset = np.array(read.joint_offset(name))
        at, rotation = (np.zeros(3), np.eye(3)) if parent is None else place(parent.name, frame)
        if parent is None:
            offset = offset + [read.frame_joint_channel(frame, name, f"{a}position") for a in "XYZ"]
        at = at + rotation @ offset
        for channel in read.joint_channels(name):
            if channel.endswith("rotation"):
                rotation = rotation @ turn(channel[0], read.frame_joint_channel(frame, name, channel))
        return at, rotation

    for frame in np.flatnonzero(found):
        for name in names[1:]:
            at, rotation = place(name, frame)
            same(10 * at, points[frame, joints.index(name)], 1e-3)
            ends = [child for child in read.get_joint(name).children if child.value[0] == "End"]
            for end in ends:
                tip = at + rotation @ np.array([float(x) for x in end["OFFSET"]])
                same(10 * tip, points[frame, joints.index(name.rsplit("_", 1)[0] + "_tip")], 1e-3)
    # The lost frame keeps the pose before.
    lost = int(np.flatnonzero(~found)[0])
    assert read.frames[lost] == read.frames[lost - 1]


def quaternion(q):
    x, y, z, w = q
    return np.array([
        [1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w)],
        [2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w)],
        [2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y)],
    ])


def check_glb():
    data = (folder / "take.glb").read_bytes()
    length = int.from_bytes(data[12:16], "little")
    gltf, binary = json.loads(data[20 : 20 + length]), data[28 + length :]
    sizes = {"SCALAR": 1, "VEC3": 3, "VEC4": 4, "MAT4": 16}
    kinds = {5121: np.uint8, 5123: np.uint16, 5126: np.float32}

    def accessor(index):
        this = gltf["accessors"][index]
        start = gltf["bufferViews"][this["bufferView"]]["byteOffset"]
        count = this["count"] * sizes[this["type"]]
        values = np.frombuffer(binary, kinds[this["componentType"]], count, start)
        return values.reshape(this["count"], -1)

    animation = gltf["animations"][0]
    tracks = {}
    for channel in animation["channels"]:
        sampler = animation["samplers"][channel["sampler"]]
        target = channel["target"]
        tracks[target["node"], target["path"]] = accessor(sampler["output"])
        same(accessor(sampler["input"])[:, 0], times[found] - times[found][0], 1e-5)
    parents = {c: k for k, node in enumerate(gltf["nodes"]) for c in node.get("children", [])}

    def place(node, key):
        this = gltf["nodes"][node]
        rotation, at = this.get("rotation"), this.get("translation", [0, 0, 0])
        if (node, "rotation") in tracks:
            rotation = tracks[node, "rotation"][key]
        if (node, "translation") in tracks:
            at = tracks[node, "translation"][key]
        own = np.eye(4)
        own[:3, :3], own[:3, 3] = quaternion(rotation), at
        return (place(parents[node], key) if node in parents else np.eye(4)) @ own

    bones = gltf["skins"][0]["joints"]
    inverse = accessor(gltf["skins"][0]["inverseBindMatrices"]).reshape(-1, 4, 4).swapaxes(1, 2)
    mesh = gltf["meshes"][0]["primitives"][0]["attributes"]
    corners, owners = accessor(mesh["POSITION"]), accessor(mesh["JOINTS_0"])[:, 0]
    for key in range(found.sum()):
        expected = points[found][key]
        for bone in bones[1:]:
            at = place(bone, key)[:3, 3]
            same(1000 * at, expected[joints.index(gltf["nodes"][bone]["name"])], 2e-3)
        # The skin follows: from the index's tip it is as far as the finger is thick there.
        bone = next(k for k in bones if gltf["nodes"][k]["name"] == "index_dip")
        moved = place(bone, key) @ inverse[bone]
        skin = corners[owners == bone] @ moved[:3, :3].T + moved[:3, 3]
        tip = expected[joints.index("index_tip")] / 1000
        radius = header["hand"]["index"]["radii_mm"][3] / 1000
        same(np.linalg.norm(skin - tip, axis=1).min(), radius)


for check in [check_schema, check_csv, check_npz, check_trc, check_motion, check_c3d, check_bvh, check_glb]:
    check()
    print(f"{check.__name__}: the same values")
