"""Units of a sweep's columns: of measures from their records, of inputs from the scene."""

from anet_lumped.scene.units import unit_of_field
from studies.sweeping.measures import MEASURES


def unit_of(scene, column: str) -> str:
    """The unit of a column of a sweep of a scene, "" where it has none or none is known."""
    name = column.partition(":")[0]
    if name in MEASURES:
        return MEASURES[name].unit.replace("-", "")
    return unit_of_field(scene, column)


def with_units(scene, columns) -> dict[str, str]:
    """For each column its name with its unit in brackets."""
    units = {column: unit_of(scene, column) for column in columns}
    return {column: f"{column} [{unit}]" if unit else column for column, unit in units.items()}
