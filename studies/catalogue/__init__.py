"""Cases that are hard for any method, each with the physical statement that must hold."""

from studies.catalogue import falls, flights, supports, swings

CASES = swings.CASES | supports.CASES | falls.CASES | flights.CASES
"""Names of cases -> functions that make them."""
