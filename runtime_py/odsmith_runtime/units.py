"""Units of values on the bus, with exact scales."""

from __future__ import annotations

from .rows import Row

TYPE_CHECKING = False
if TYPE_CHECKING:
    from fractions import Fraction
    from numbers import Rational


class Unit(Row):
    """A unit: one count is `numerator/denominator` of `base`, exactly.

    Where `selected_by` names an object, its value chooses one of `options` (value, name of a unit); the scale given
    here is then that of the choice as delivered.
    """

    name: str
    symbol: str
    quantity: str
    base: str
    numerator: int
    denominator: int
    text: str = ""
    selected_by: str = ""
    options: tuple[tuple[int, str], ...] = ()

    @property
    def scale(self) -> Fraction:
        """How much of `base` one count is."""
        from fractions import Fraction

        return Fraction(self.numerator, self.denominator)

    def to_base(self, count: int) -> Fraction:
        """A value of the bus as an exact amount of `base`."""
        return count * self.scale

    def from_base(self, amount: Rational | float) -> int:
        """The value of the bus that comes nearest to an amount of `base`; halves go to the even neighbour."""
        from fractions import Fraction

        return round(Fraction(amount) / self.scale)
