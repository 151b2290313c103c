"""IEEE 754 arithmetic on bits, by exact rational numbers: what instructions must return, without the processor's."""

from fractions import Fraction
from math import isqrt

ROOT_BITS = 800  # bits of a square root before it is rounded; its remainder decides ties


class Format:
    """Binary floating point. NaN results are `nan`, as the ISA says for f32."""

    def __init__(self, width, mantissa, nan):
        self.width = width
        self.mantissa = mantissa
        self.nan = nan
        self.sign_bit = 1 << (width - 1)
        self.infinity = ((1 << (width - 1 - mantissa)) - 1) << mantissa
        self.lowest = 2 - (1 << (width - 2 - mantissa)) - mantissa  # exponent of the smallest denormal number

    def is_nan(self, bits):
        return bits & ~self.sign_bit > self.infinity

    def is_infinite(self, bits):
        return bits & ~self.sign_bit == self.infinity

    def is_negative(self, bits):
        return bits >= self.sign_bit

    def is_subnormal(self, bits):
        return 0 < bits & ~self.sign_bit < 1 << self.mantissa

    def value(self, bits):
        """The exact value of a finite number."""
        size = bits & ~self.sign_bit
        exponent, fraction = size >> self.mantissa, size & ((1 << self.mantissa) - 1)
        whole = fraction if exponent == 0 else fraction | 1 << self.mantissa
        value = whole * Fraction(2) ** (self.lowest + max(exponent, 1) - 1)
        return -value if self.is_negative(bits) else value

    def round(self, value, mode="rn", negative_zero=False):
        """The bits of a rounded value; zero gets the given sign."""
        if value == 0:
            return self.sign_bit if negative_zero else 0
        sign = self.sign_bit if value < 0 else 0
        size = abs(value)
        exponent = size.numerator.bit_length() - size.denominator.bit_length()
        if size < Fraction(2) ** exponent:
            exponent -= 1
        unit = max(exponent - self.mantissa, self.lowest)
        scaled = size / Fraction(2) ** unit
        whole = scaled.numerator // scaled.denominator
        whole += rounds_up(scaled - whole, whole, mode, value < 0)
        bits = whole + ((unit - self.lowest) << self.mantissa)
        if bits >= self.infinity:
            towards_infinity = mode == "rn" or mode == ("rm" if value < 0 else "rp")
            bits = self.infinity if towards_infinity else self.infinity - 1
        return sign | bits

    # ---- Operations

    def add(self, a, b):
        if self.is_nan(a) or self.is_nan(b):
            return self.nan
        if self.is_infinite(a) or self.is_infinite(b):
            if self.is_infinite(a) and self.is_infinite(b) and a != b:
                return self.nan
            return a if self.is_infinite(a) else b
        return self.round(self.value(a) + self.value(b), negative_zero=self.is_negative(a) and self.is_negative(b))

    def sub(self, a, b):
        return self.nan if self.is_nan(b) else self.add(a, b ^ self.sign_bit)

    def mul(self, a, b):
        if self.is_nan(a) or self.is_nan(b):
            return self.nan
        sign = (a ^ b) & self.sign_bit
        if self.is_infinite(a) or self.is_infinite(b):
            zero = any(x & ~self.sign_bit == 0 for x in (a, b))
            return self.nan if zero else sign | self.infinity
        return self.round(self.value(a) * self.value(b), negative_zero=sign != 0)

    def div(self, a, b):
        if self.is_nan(a) or self.is_nan(b) or (self.is_infinite(a) and self.is_infinite(b)):
            return self.nan
        sign = (a ^ b) & self.sign_bit
        if self.is_infinite(a):
            return sign | self.infinity
        if self.is_infinite(b):
            return sign
        if self.value(b) == 0:
            return self.nan if self.value(a) == 0 else sign | self.infinity
        return self.round(self.value(a) / self.value(b), negative_zero=sign != 0)

    def rcp(self, a):
        return self.div(self.round(Fraction(1)), a)

    def fma(self, a, b, c):
        if any(map(self.is_nan, (a, b, c))):
            return self.nan
        if any(map(self.is_infinite, (a, b, c))):
            product = self.mul(a, b) if self.is_infinite(a) or self.is_infinite(b) else 0
            return product if self.is_nan(product) else self.add(product, c)
        negative = self.is_negative(a) != self.is_negative(b)
        return self.round(self.value(a) * self.value(b) + self.value(c), negative_zero=negative and self.is_negative(c))

    def sqrt(self, a):
        if self.is_nan(a) or (self.is_negative(a) and a != self.sign_bit):
            return self.nan
        if self.is_infinite(a) or self.value(a) == 0:
            return a
        scaled = self.value(a) * 4**ROOT_BITS * 4
        whole = scaled.numerator // scaled.denominator
        root = isqrt(whole)
        exact = root * root == whole and scaled.denominator == 1
        return self.round(Fraction(2 * root + (not exact), 4 << ROOT_BITS))

    def abs(self, a):
        return self.nan if self.is_nan(a) else a & ~self.sign_bit

    def neg(self, a):
        return self.nan if self.is_nan(a) else a ^ self.sign_bit

    def copysign(self, a, b):
        return (a & self.sign_bit) | (b & ~self.sign_bit)

    def order(self, a):
        """A number by which values sort, −0 before +0."""
        return -(a & ~self.sign_bit) - 1 if self.is_negative(a) else a

    def min(self, a, b):
        numbers = [x for x in (a, b) if not self.is_nan(x)]
        return min(numbers, key=self.order) if numbers else self.nan

    def max(self, a, b):
        numbers = [x for x in (a, b) if not self.is_nan(x)]
        return max(numbers, key=self.order) if numbers else self.nan

    def compare(self, a, b):
        """−1, 0 or 1, or None if one is NaN."""
        if self.is_nan(a) or self.is_nan(b):
            return None
        a, b = (0 if x == self.sign_bit else self.order(x) for x in (a, b))
        return (a > b) - (a < b)

    def to_integral(self, a, mode):
        """The value rounded to an integer of the same format."""
        if self.is_nan(a):
            return self.nan
        if self.is_infinite(a):
            return a
        return self.round(Fraction(round_to_integer(self.value(a), mode)), negative_zero=self.is_negative(a))

    def to_format(self, a, other, mode="rn"):
        if self.is_nan(a):
            return other.nan
        if self.is_infinite(a):
            return other.infinity | (other.sign_bit if self.is_negative(a) else 0)
        return other.round(self.value(a), mode, negative_zero=self.is_negative(a))


def rounds_up(rest, whole, mode, negative):
    """Whether the size of a number grows when it is rounded; `rest`: what is beyond the last bit, in [0, 1)."""
    if mode == "rn":
        return rest > Fraction(1, 2) or (rest == Fraction(1, 2) and whole % 2 == 1)
    return rest > 0 and mode == ("rm" if negative else "rp")


def round_to_integer(value, mode):
    """`mode`: rni, rzi, rmi or rpi."""
    size = abs(value)
    whole = size.numerator // size.denominator
    whole += rounds_up(size - whole, whole, mode[:-1], value < 0)
    return -whole if value < 0 else whole


F32 = Format(32, 23, 0x7FFFFFFF)
F64 = Format(64, 52, 0xFFF8000000000000)
FORMATS = {"f32": F32, "f64": F64}
