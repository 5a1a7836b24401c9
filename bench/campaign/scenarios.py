"""The smallest cases, specification and spacecraft that the campaign works on."""

from __future__ import annotations

import json
from pathlib import Path

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
name = "three joints"
convention = "denavit_hartenberg"
near_deg = [0.0, 60.0, -90.0]
[[joint]]
name = "shoulder"
a_m = 0.0
alpha_deg = -90.0
d_m = 0.3
lower_deg = -170.0
upper_deg = 170.0
[[joint]]
name = "elbow"
a_m = 1.0
alpha_deg = 0.0
d_m = 0.0
lower_deg = -120.0
upper_deg = 120.0
[[joint]]
name = "wrist"
a_m = 0.8
alpha_deg = 0.0
d_m = 0.0
lower_deg = -120.0
upper_deg = 120.0
[tool]
place_m = [0.0, 0.0, 0.1]
rpy_deg = [0.0, 90.0, 0.0]
"""
URDF = """<robot name="two"><link name="base"/><link name="upper">
<collision><origin xyz="0 0 0.2"/><geometry><cylinder radius="0.05" length="0.4"/></geometry>
</collision>
</link><link name="lower"><collision><geometry><sphere radius="0.06"/></geometry></collision></link>
<joint name="a" type="revolute"><parent link="base"/><child link="upper"/><axis xyz="0 0 1"/>
<origin xyz="0 0 0.1" rpy="0 0 0"/><limit lower="-2.9" upper="2.9" effort="1" velocity="1"/></joint>
<joint name="b" type="continuous"><parent link="upper"/><child link="lower"/><axis xyz="0 1 0"/>
<origin xyz="0 0 0.4"/></joint></robot>
"""
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


def write_cases(folder: Path) -> None:
    """Write every case, and the files that they name, into a folder."""
    texts = {
        "small.toml": PAIRS,
        "turning.toml": TUMBLE.replace("[told.inertia]\noffset_percent = 0.0\n", ""),
        "own.toml": OWN,
        "armed.toml": ARMED,
        "urdf.toml": ARMED.replace("arm.toml", "arm.urdf"),
        "probe.toml": PROBE,
        "markers.toml": MARKERS,
        "poses.csv": POSES,
        "arm.toml": ARM,
        "arm.urdf": URDF,
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
