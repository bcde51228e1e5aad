/* root.h: roots, without <math.h>, which not every machine has: for streams and for bounds of models. */

/* Of a number that is 0 or more: the root of a number from 1/4 to 4, by Newton, times a power of 2. */
static real root(real square)
{
    real power = 1;
    real near = 1;
    if (!(square > 0 && square - square == 0)) {
        return square;
    }
    while (square > 4) {
        square /= 4;
        power *= 2;
    }
    while (square < (real)0.25) {
        square *= 4;
        power /= 2;
    }
    for (int k = 0; k < 6; ++k) {
        near = (near + square / near) / 2;
    }
    return power * near;
}
