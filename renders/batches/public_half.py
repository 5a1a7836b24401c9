"""What a flight computer is given of a world, as the files of a dataset's public half."""

from __future__ import annotations

from models.dataset.description import DatasetInfo, Stream
from models.dataset.onboard_files import onboard_texts
from models.dataset.sensor_table import table_to_csv
from models.frame import TableReading
from renders.world.table_sensors import TableSensor
from renders.world.world import World


def dataset_info(world: World) -> DatasetInfo:
    """Return what ``dataset.json`` says of a world, but for who made it.

    Raises
    ------
    ScenarioError
        If the target lacks what is to be known of it on board.
    """
    images = tuple(
        Stream(each.name, "image", each.files, offset_s=each.offset_s)
        for each in world.sensor.streams
    )
    tables = tuple(
        Stream(each.name, "table", each.file, columns=each.columns) for each in world.tables
    )
    return DatasetInfo(
        case=world.scenario.name,
        sun=world.scenario.sun.default,
        frames=len(world.scenario.times_s),
        target=world.target.name,
        chain=world.chain,
        streams=(*images, *tables),
        onboard=tuple(onboard_texts(world.onboard(0))),
        provenance={"scenario": world.scenario.fingerprint()},
    )


def public_files(world: World, run: int = 0) -> dict[str, str]:
    """Return the texts of the files that a run is given, by name.

    ``dataset.json``, ``frames.csv`` and the frames themselves are not among them.

    Raises
    ------
    ScenarioError
        If the target lacks what is to be known of it on board.
    """
    tables = {
        sensor.file: table_to_csv(sensor.columns, table_readings(world, sensor, run))
        for sensor in world.tables
    }
    return {**onboard_texts(world.onboard(run)), **tables}


def table_readings(world: World, sensor: TableSensor, run: int) -> list[tuple[int, TableReading]]:
    """Return what a sensor gives in a run, by frame; its times are those of the clock on board.

    Parameters
    ----------
    world : World
    sensor : TableSensor
    run : int
    """
    times_s = world.scenario.times_s
    clock = world.clock(run)
    return [
        (frame, clock.stamped_rows(sensor.reading(frame, time_s, since_s, run)))
        for frame, (time_s, since_s) in enumerate(
            zip(times_s, [float("-inf"), *times_s], strict=False)
        )
    ]
