"""The smallest cases, specification and spacecraft that the campaign works on."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import trimesh

PAIRS = """
name = "small"
[camera]
width = 128
[motion]
start_s = 200.0
end_s = 210.0
rate_hz = 0.1
[sun]
shared = ["S2", "S3"]
[render]
samples = 4
marker_samples = 16
max_depth = 2
"""
TUMBLE = """
name = "turning"
target = "xmm"
[camera]
width = 64
[motion]
end_s = 40.0
rate_hz = 0.05
[sun]
default = "0.1,0.2,1.0"
[earth]
shines = true
[render]
samples = 4
max_depth = 2
[exposure]
mode = "fixed"
exposure_ms = 4.0
[told.inertia]
offset_percent = 0.0
[tumble]
rho0_m = [0.0, 30.0, 0.0]
rho_dot0_m_s = [0.0, 1e-4, 0.0]
omega0_deg_s = [0.5, -0.3, 0.2]
inertia_kg_m2 = [[7052.0, -820.0, -3991.0], [-820.0, 129129.0, 0.0], [-3991.0, 0.0, 131196.0]]
[tumble.orbit]
a_km = 7143.1
e = 1.4e-4
i_deg = 98.2
argument_of_perigee_deg = 85.9
raan_deg = 79.2
[tumble.onboard]
range_m = [20.0, 40.0]
"""
LIT = """
name = "lit"
target = "probe.toml"
markers = "markers.toml"
[camera]
width = 64
height = 48
fx = 70.0
fy = 69.0
cx = 31.0
cy = 24.0
[motion]
file = "poses.csv"
[sun]
shared = ["S2", "S3"]
[render]
samples = 4
max_depth = 2
"""
OWN = """
name = "own"
target = "probe.toml"
markers = "markers.toml"
[camera]
width = 64
height = 48
fx = 70.0
fy = 69.0
cx = 31.0
cy = 24.0
k1 = -0.1
[motion]
file = "poses.csv"
[render]
samples = 2
max_depth = 2
[exposure]
mode = "fixed"
exposure_ms = 4.0
[told.camera]
cx = { sigma = 1.0 }
cy = { offset = 0.5 }
"""
ARMED = """
name = "armed"
[camera]
width = 64
[motion]
start_s = 320.0
end_s = 330.0
rate_hz = 0.1
[arm]
file = "arm.toml"
[render]
samples = 2
max_depth = 2
"""
FLIGHT = """
name = "chaser"
[camera]
width = 512
[motion]
start_s = 284.0
end_s = 294.0
rate_hz = 0.1
[arm]
camera = "chaser"
[render]
samples = 4
max_depth = 2
"""
HAND = """
name = "hand"
target = "maxar1300_grasp"
[frame]
kind = "colour"
[camera]
preset = "eye_in_hand"
width = 512
[motion]
ring_in_target_m = [0.0, -0.83, 0.0]
start_s = 284.0
end_s = 294.0
rate_hz = 0.1
[arm]
camera = "hand"
grasp_in_target_m = [0.0, 0.0, 0.0]
[exposure]
mode = "fixed"
exposure_ms = 3.0
[prior]
by = "arm"
[render]
samples = 4
max_depth = 2
"""
PROBE = """
name = "probe"
mesh = "probe.stl"
unit = "mm"
material = "anodised_aluminium"
smooth_deg = 30.0
origin = "mesh"
mass_kg = 480.0
[axes]
x = "+z"
y = "+x"
z = "+y"
[parts]
"*" = "my_paint"
[materials.my_paint]
diffuse = [0.80, 0.81, 0.79]
specular = 0.02
roughness = 0.4
[wireframe]
find = true
sharp_deg = 25.0
most_landmarks = 60
[wireframe.landmarks]
tip = [0.5, 0.5, 0.5]
"""
MARKERS = """
radius_m = 0.0127
[[marker]]
name = "1"
point_in_target_m = [-0.3, -0.3, 0.51]
normal_in_target = [0.0, 0.0, 1.0]
[[marker]]
name = "2"
point_in_target_m = [0.3, -0.3, 0.51]
normal_in_target = [0.0, 0.0, 1.0]
[[marker]]
name = "3"
point_in_target_m = [0.0, 0.3, 0.6]
normal_in_target = [0.0, 0.0, 1.0]
[[marker]]
name = "4"
point_in_target_m = [0.1, 0.0, 0.55]
normal_in_target = [0.0, 0.0, 1.0]
"""
POSES = """time_s,t_cam_from_target_x_m,t_cam_from_target_y_m,t_cam_from_target_z_m,\
q_cam_from_target_w,q_cam_from_target_x,q_cam_from_target_y,q_cam_from_target_z
0.0,0.0,0.1,6.7,0.0,1.0,0.0,0.0
1.0,0.0,0.1,6.6,0.0,1.0,0.0,0.0
2.0,0.0,0.1,6.5,0.0,1.0,0.0,0.0
"""
ARM = """
name = "seven joints"
convention = "denavit_hartenberg"
near_deg = [143.0, -36.0, -81.0, -101.0, 36.0, 103.0, -53.0]
"""
ARM_ROWS = (
    ("shoulder_roll", -90.0, 0.30, 170.0),
    ("shoulder_pitch", 90.0, 0.0, 120.0),
    ("shoulder_yaw", -90.0, 1.05, 170.0),
    ("elbow", 90.0, 0.0, 150.0),
    ("wrist_roll", -90.0, 1.00, 170.0),
    ("wrist_pitch", 90.0, 0.0, 120.0),
    ("hand_roll", 0.0, 0.60, 175.0),
)
"""Name, alpha in deg, d in m and how far it turns either way: a, in m, is nothing."""
SPEC = """
name = "few"
frames = 4
seed = 1
suns_per_pose = 2
[[target]]
spacecraft = "hispasat"
range_m = [40.0, 90.0]
[[target]]
spacecraft = "xmm"
[[camera]]
name = "wide"
width = 64
[pose]
range_m = [20.0, 80.0]
"""
DRAWN = """
name = "drawn"
frames = 12
seed = 1
suns_per_pose = 2
[[target]]
spacecraft = "probe.toml"
[[camera]]
name = "wide"
width = 64
[pose]
range_m = [4.0, 20.0]
"""


def _joint(row: tuple[str, float, float, float]) -> str:
    """Return a joint of an arm's TOML."""
    name, alpha_deg, d_m, most_deg = row
    return (
        f'[[joint]]\nname = "{name}"\na_m = 0.0\nalpha_deg = {alpha_deg}\nd_m = {d_m}\n'
        f"lower_deg = {-most_deg}\nupper_deg = {most_deg}\n"
    )


def _urdf() -> str:
    """Return the same arm as a URDF: a joint stands where the row before it ends."""
    links = ['<link name="base"/>', '<link name="tool"/>']
    joints, parent, xyz, roll = list[str](), "base", "0 0 0", 0.0
    for name, alpha_deg, d_m, most_deg in ARM_ROWS:
        links.append(
            f'<link name="{name}"><collision><geometry><sphere radius="0.06"/></geometry>'
            "</collision></link>"
        )
        most = np.deg2rad(most_deg)
        joints.append(
            f'<joint name="{name}" type="revolute"><parent link="{parent}"/><child link="{name}"/>'
            f'<axis xyz="0 0 1"/><origin xyz="{xyz}" rpy="{roll} 0 0"/>'
            f'<limit lower="{-most}" upper="{most}" effort="1" velocity="1"/></joint>'
        )
        parent, xyz, roll = name, f"0 0 {d_m}", np.deg2rad(alpha_deg)
    joints.append(
        f'<joint name="flange" type="fixed"><parent link="{parent}"/><child link="tool"/>'
        f'<origin xyz="{xyz}"/></joint>'
    )
    return f'<robot name="seven">{"".join(links)}\n{chr(10).join(joints)}\n</robot>\n'


def write_cases(folder: Path) -> None:
    """Write every case, and the files that they name, into a folder."""
    texts = {
        "small.toml": PAIRS,
        "turning.toml": TUMBLE.replace("[told.inertia]\noffset_percent = 0.0\n", ""),
        "own.toml": OWN,
        "lit.toml": LIT,
        "hand.toml": HAND,
        "chaser.toml": FLIGHT,
        "drawn.toml": DRAWN,
        "armed.toml": ARMED,
        "urdf.toml": ARMED.replace("arm.toml", "arm.urdf"),
        "probe.toml": PROBE,
        "markers.toml": MARKERS,
        "poses.csv": POSES,
        "arm.toml": ARM + "".join(map(_joint, ARM_ROWS)),
        "arm.urdf": _urdf(),
        "spec.toml": SPEC,
    }
    folder.mkdir(parents=True, exist_ok=True)
    for name, text in texts.items():
        (folder / name).write_text(text.lstrip("\n"))
    write_meshes(folder)


def write_meshes(folder: Path) -> None:
    """Write a body with two parts in every format: ``probe.*`` in mm, ``look.*`` in m."""
    bus = trimesh.creation.box((1.2, 0.9, 1.0))
    boom = trimesh.creation.cylinder(0.1, 1.1, sections=8)
    boom.apply_translation([0.3, 0.2, 1.0])
    scene = trimesh.Scene()
    scene.add_geometry(bus, node_name="bus", geom_name="bus")
    scene.add_geometry(boom, node_name="boom", geom_name="boom")
    both = trimesh.util.concatenate([bus, boom])
    for ending in ("glb", "obj", "stl", "ply"):
        made = scene.export(file_type="glb") if ending == "glb" else both.export(file_type=ending)
        data = made.encode() if isinstance(made, str) else bytes(made)
        (folder / f"look.{ending}").write_bytes(data)
    text = both.export(file_type="ply", encoding="ascii")
    (folder / "look_text.ply").write_bytes(text.encode() if isinstance(text, str) else text)
    stl = both.export(file_type="stl_ascii")
    (folder / "look_text.stl").write_text(stl)
    files = {name: bytes(data) for name, data in scene.export(file_type="gltf").items()}
    files["look.gltf"] = files.pop("model.gltf")
    for name, data in files.items():
        (folder / name).write_bytes(data)
    json.loads(files["look.gltf"])  # it is one
    both.apply_scale(1e3)
    (folder / "probe.stl").write_bytes(bytes(both.export(file_type="stl")))
