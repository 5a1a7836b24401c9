"""Image pairs without a renderer: discs by supersampled rays, clutter, and a noisy detector.

Independent of the renderer and of the pipeline's own disc model: each sub-pixel's ray meets the
marker's plane, coverage is averaged over pixels, the lens blurs sub-pixels, then come Poisson and
read noise, clipping and 12-bit rounding.
"""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np
from scipy.ndimage import gaussian_filter
from scipy.special import ndtr

from models.arrays import Floats, Image
from models.camera import Camera
from models.frame import IMAGE_800, IMAGE_850, Frame, ImageReading
from models.markers import CornerCubes, MarkerPattern
from models.pose import RigidTransform, euler_321_from_rotation, rotation_from_euler_321
from models.sensors.camera_chip import Detector
from pipelines.pnp.flight_knowledge import FlightKnowledge
from tests.support.traced_cube import comes_back

CAMERA_2048 = Camera.from_fov(2048, 2048, 50.0)
CAMERA_1024 = Camera.from_fov(1024, 1024, 50.0)
PAIR_GAP_S = 0.033  # from the 800 nm exposure to the 850 nm one: 30 Hz
EXPOSURE_MS = 20.0
PRIOR_SIGMA_M = np.array([0.017, 0.017, 0.05])  # Opromolla et al. 2022, Table 5
PRIOR_SIGMA_DEG = np.array([1.0, 1.0, 1.0])


def stand_in_pattern() -> MarkerPattern:
    """Ten markers after the paper's description: nine coplanar, #10 0.2 m in front of them."""
    points = np.array(
        [
            [-1.10, -0.45, 0.0],
            [1.10, -0.45, 0.0],
            [-0.80, -0.70, 0.0],
            [0.80, -0.70, 0.0],
            [-0.45, -0.95, 0.0],
            [0.50, -1.15, 0.0],
            [-0.20, -0.85, 0.0],
            [0.20, -0.85, 0.0],
            [-0.15, -1.10, 0.0],
            [0.05, -1.00, 0.20],
        ]
    )
    normals = np.tile([0.0, 0.0, 1.0], (len(points), 1))
    names = tuple(str(number) for number in range(1, len(points) + 1))
    return MarkerPattern(names, points, normals, 0.0127)


PATTERN = stand_in_pattern()
PATTERN_CENTRE = np.array([0.0, -0.75, 0.0])


def facing_pose(
    range_m: float,
    euler_deg: tuple[float, float, float] = (180.0, 0.0, 0.0),
    aim: Floats = PATTERN_CENTRE,
    offset_m: tuple[float, float] = (0.0, 0.0),
) -> RigidTransform:
    """Return the pose that sees ``aim`` (target frame) at (offset_x, offset_y, range) m."""
    rotation = rotation_from_euler_321(euler_deg)
    return RigidTransform(rotation, np.array([*offset_m, range_m]) - rotation @ aim)


@dataclass(frozen=True, eq=False)
class Scene:
    """What a pair shows.

    Attributes
    ----------
    camera, detector, markers
        As they are; give the pipeline others to misinform it.
    level : float
        Marker signal over full well.
    levels : (n,) array or None
        The same, per marker.
    gradient : float
        Relative change of a disc's radiance over one radius.
    gradient_deg : float, deg
        Direction of that change in the image.
    psf_sigma_px : float, px
    clutter : int or None
        Seed of the sunlit structure that both images share.
    clutter_motion_px : tuple of float, px
        How far it moves between the exposures.
    support_level : float
        Sunlit signal of the plate round a marker, over full well.
    cut : dict
        Marker index to share of its diameter that something hides, from the left.
    prnu : float
        Pixel response non-uniformity, 1 sigma.
    supersampling : int
    cubes : CornerCubes or None
        What the markers are, with all edges; even discs unless given.
    even_share : float
        Of a cube's light, what its face sends back evenly.
    """

    camera: Camera = CAMERA_1024
    detector: Detector = field(default_factory=Detector)
    markers: MarkerPattern = field(default_factory=stand_in_pattern)
    level: float = 0.6
    levels: Floats | None = None
    gradient: float = 0.0
    gradient_deg: float = 0.0
    psf_sigma_px: float = 0.5
    clutter: int | None = None
    clutter_motion_px: tuple[float, float] = (0.02, 0.02)
    support_level: float = 0.03
    cut: dict[int, float] = field(default_factory=dict)
    prnu: float = 0.0
    supersampling: int = 8
    cubes: CornerCubes | None = None
    even_share: float = 0.0


def marker_window(scene: Scene, pose: RigidTransform, index: int) -> tuple[slice, slice] | None:
    """Return the image rows and columns that a marker's disc and blur touch, or None."""
    camera, markers = scene.camera, scene.markers
    centre = pose @ markers.points_in_target[index]
    if centre[2] < 0.1:
        return None
    u, v = camera.project(centre)
    reach = camera.fx * markers.radius_m / centre[2] * 1.3 + 6.0 * scene.psf_sigma_px + 2.0
    rows = slice(max(int(v - reach), 0), min(int(v + reach) + 2, camera.height))
    columns = slice(max(int(u - reach), 0), min(int(u + reach) + 2, camera.width))
    return (rows, columns) if rows.start < rows.stop and columns.start < columns.stop else None


def disc_share(
    scene: Scene, pose: RigidTransform, index: int, window: tuple[slice, slice]
) -> Floats:
    """Return a disc's relative radiance per pixel of a window, blurred by the lens.

    Pixels beyond the image are sampled too, so that the blur knows what lies there.
    """
    factor, markers = scene.supersampling, scene.markers
    pad = int(np.ceil(4.0 * scene.psf_sigma_px)) + 1
    rows = np.arange(window[0].start - pad, window[0].stop + pad)
    columns = np.arange(window[1].start - pad, window[1].stop + pad)
    sub = (np.arange(factor) + 0.5) / factor - 0.5
    u, v = np.meshgrid(
        (columns[:, None] + sub).reshape(-1), (rows[:, None] + sub).reshape(-1), indexing="xy"
    )
    normalised = scene.camera.normalise(np.stack([u.reshape(-1), v.reshape(-1)], axis=-1))
    rays = np.concatenate([normalised, np.ones((len(normalised), 1))], axis=1)

    centre = pose @ markers.points_in_target[index]
    normal = pose.rotate(markers.normals_in_target[index])
    hits = rays * ((centre @ normal) / (rays @ normal))[:, None] - centre
    distance = np.linalg.norm(hits, axis=1)
    pixel_m = centre[2] / scene.camera.fx / factor  # one sub-pixel, on the disc
    coverage = np.clip((markers.radius_m - distance) / pixel_m + 0.5, 0.0, 1.0)
    direction = np.deg2rad(scene.gradient_deg)
    along = (hits[:, 0] * np.cos(direction) + hits[:, 1] * np.sin(direction)) / markers.radius_m
    radiance = coverage * (1.0 + scene.gradient * along)
    if scene.cubes is not None:
        radiance = radiance * cube_share(scene, scene.cubes, pose, index, hits)
    if index in scene.cut:
        radiance = radiance * (hits[:, 0] / markers.radius_m > -1.0 + 2.0 * scene.cut[index])
    fine = gaussian_filter(radiance.reshape(u.shape), scene.psf_sigma_px * factor, truncate=6.0)
    blocks = fine.reshape(len(rows), factor, len(columns), factor).mean(axis=(1, 3))
    return np.asarray(blocks[pad:-pad, pad:-pad])


def cube_share(
    scene: Scene, cubes: CornerCubes, pose: RigidTransform, index: int, places: Floats
) -> Floats:
    """Return what places of a face, (n, 3) m from its centre, return of what an even disc would."""
    normal = pose.rotate(scene.markers.normals_in_target[index])
    assert cubes.edges_in_target is not None
    edge = pose.rotate(cubes.edges_in_target[index])
    axes = np.stack([edge, np.cross(normal, edge), normal])
    towards = -(pose @ scene.markers.points_in_target[index])
    x, y = (places @ axes[:2].T).T / scene.markers.radius_m
    back = np.zeros(len(x))
    near = np.hypot(x, y) < 1.1
    back[near] = comes_back(
        x[near],
        y[near],
        axes @ towards / np.linalg.norm(towards),
        cubes.refractive_index,
        cubes.edge_share,
    )
    return scene.even_share + (1.0 - scene.even_share) * back


def marker_levels(scene: Scene) -> Floats:
    """Return each marker's signal over full well."""
    count = len(scene.markers)
    return np.full(count, scene.level) if scene.levels is None else np.asarray(scene.levels)


def markers_signal(scene: Scene, pose: RigidTransform) -> Floats:
    """Return the markers' signal over full well, (height, width)."""
    signal = np.zeros((scene.camera.height, scene.camera.width))
    for index, level in enumerate(marker_levels(scene)):
        window = marker_window(scene, pose, index)
        if window is not None and level > 0.0:
            signal[window] += level * disc_share(scene, pose, index, window)
    return signal


def clutter_signal(scene: Scene, shift_px: tuple[float, float]) -> Floats:
    """Return sunlit structure over full well: turned plates with soft edges, and glints."""
    camera = scene.camera
    signal = np.zeros((camera.height, camera.width))
    if scene.clutter is None:
        return signal
    rng = np.random.default_rng(scene.clutter)
    size, blur = camera.width, np.hypot(scene.psf_sigma_px, 0.29)
    for number in range(90):
        glint = number >= 40
        centre = rng.uniform(-0.05, 1.05, 2) * size
        half = rng.uniform(0.5, 4.0, 2) if glint else rng.uniform(0.01, 0.12, 2) * size
        angle, level = rng.uniform(0, np.pi), 10.0 ** rng.uniform(-2.3, 0.0)
        level = 10.0 ** rng.uniform(0.0, 1.5) if glint else level
        reach = float(np.hypot(*half) + 6.0 * blur)
        low = np.maximum(np.floor(centre - reach).astype(int), 0)
        high = np.minimum(np.ceil(centre + reach).astype(int) + 1, size)
        if (low >= high).any():
            continue
        x = np.arange(low[0], high[0]) - centre[0] - shift_px[0]
        y = (np.arange(low[1], high[1]) - centre[1] - shift_px[1])[:, None]
        along, across = x * np.cos(angle) + y * np.sin(angle), y * np.cos(angle) - x * np.sin(angle)
        inside = np.ones_like(along)
        for where, width in ((along, half[0]), (across, half[1])):
            inside = inside * (ndtr((where + width) / blur) - ndtr((where - width) / blur))
        signal[low[1] : high[1], low[0] : high[0]] += level * inside
    return signal


def supports_mask(scene: Scene, pose: RigidTransform) -> Floats:
    """Return 1 on the plates that carry the markers (three marker radii), soft at the edge."""
    mask = np.zeros((scene.camera.height, scene.camera.width))
    for index in range(len(scene.markers)):
        centre = pose @ scene.markers.points_in_target[index]
        radius = 3.0 * scene.camera.fx * scene.markers.radius_m / centre[2]
        u, v = scene.camera.project(centre)
        rows = np.arange(max(int(v - radius - 4), 0), min(int(v + radius + 5), len(mask)))
        columns = np.arange(max(int(u - radius - 4), 0), min(int(u + radius + 5), mask.shape[1]))
        if len(rows) and len(columns):
            distance = np.hypot(columns - u, (rows - v)[:, None])
            part = np.ix_(rows, columns)
            mask[part] = np.maximum(mask[part], ndtr((radius - distance) / 0.6))
    return mask


def expose(electrons: Floats, detector: Detector, rng: np.random.Generator) -> Image:
    """Turn expected electrons into DN: shot noise, full well, read noise, gain, rounding."""
    charge = np.minimum(rng.poisson(electrons), detector.full_well_e)
    charge = charge + rng.normal(0.0, detector.read_noise_e, electrons.shape)
    level = np.rint(charge / detector.gain_e_dn + detector.bias_dn)
    return np.asarray(np.clip(level, 0, detector.max_dn).astype(np.uint16))


def pair_frame(index: int, time_s: float, image_800: Image, image_850: Image) -> Frame:
    """Return a frame of two images."""
    readings = {
        IMAGE_800: ImageReading(image_800, time_s - PAIR_GAP_S, EXPOSURE_MS),
        IMAGE_850: ImageReading(image_850, time_s, EXPOSURE_MS),
    }
    return Frame(index, time_s, readings)


@dataclass(frozen=True, eq=False)
class ExpectedPair:
    """Noise-free signals over full well, to be exposed as often as a test wants."""

    scene: Scene
    signal_800: Floats
    signal_850: Floats

    def exposed(self, seed: int, index: int = 0, time_s: float = 0.0) -> Frame:
        """Draw one noisy pair."""
        rng = np.random.default_rng([seed, index])
        detector = self.scene.detector
        response: Floats | float = 1.0
        if self.scene.prnu > 0.0:
            chip = np.random.default_rng(12345)
            response = 1.0 + self.scene.prnu * chip.standard_normal(self.signal_800.shape)
        images = [
            expose(signal * response * detector.full_well_e, detector, rng)
            for signal in (self.signal_800, self.signal_850)
        ]
        return pair_frame(index, time_s, images[0], images[1])


def expected_pair(scene: Scene, pose: RigidTransform) -> ExpectedPair:
    """Make the noise-free pair seen from ``pose``, the pose of the 850 nm exposure."""
    signal_800 = clutter_signal(scene, (0.0, 0.0))
    signal_850 = clutter_signal(scene, scene.clutter_motion_px)
    if scene.clutter is not None:
        support = supports_mask(scene, pose)
        signal_800 = signal_800 * (1.0 - support) + scene.support_level * support
        signal_850 = signal_850 * (1.0 - support) + scene.support_level * support
    return ExpectedPair(scene, signal_800, signal_850 + markers_signal(scene, pose))


def render_pair(
    scene: Scene, pose: RigidTransform, seed: int = 0, index: int = 0, time_s: float = 0.0
) -> Frame:
    """Make one noisy pair."""
    return expected_pair(scene, pose).exposed(seed, index, time_s)


def knowledge_of(
    scene: Scene,
    prior: RigidTransform,
    sigma_m: Floats = PRIOR_SIGMA_M,
    sigma_deg: Floats = PRIOR_SIGMA_DEG,
) -> FlightKnowledge:
    """Tell the pipeline the truth about everything but the pose."""
    return FlightKnowledge(scene.camera, scene.detector, scene.markers, prior, sigma_m, sigma_deg)


def drawn_prior(pose: RigidTransform, seed: int, scale: float = 1.0) -> RigidTransform:
    """Draw a prior with the sigmas of Table 5, times ``scale``."""
    rng = np.random.default_rng([seed, 77])
    euler = euler_321_from_rotation(pose.rotation) + scale * rng.normal(0.0, PRIOR_SIGMA_DEG)
    return RigidTransform(
        rotation_from_euler_321(euler), pose.translation + scale * rng.normal(0.0, PRIOR_SIGMA_M)
    )
