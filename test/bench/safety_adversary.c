/* Flies the exported filter of region_maps/problems/safety/double_integrator.yaml against an adversary, and counts where
 * a state leaves its range. Arguments: steps, seed, the error of the input beside that of the code [m/s^2], and the range
 * of the wish [m/s^2]. The code may be of any type: compile with -DREAL=float for float. Prints one line; exit code 1 where
 * something left. */
#include <math.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>

#include "filter.h"

#if !defined(REAL)
#define REAL double
#endif

/* The answer of the code; 0 where there is none. */
static int answer(double p, double v, double wish, double *u) {
    const REAL theta[3] = {(REAL)p, (REAL)v, (REAL)wish};
    REAL found[1] = {0};
    const int ok = filter_evaluate(theta, found) == FILTER_OK;
    *u = (double)found[0];
    return ok;
}

static uint64_t state;

/* Steele, Lea and Flood's SplitMix64. */
static uint64_t next(void) {
    uint64_t z = (state += UINT64_C(0x9e3779b97f4a7c15));
    z = (z ^ (z >> 30)) * UINT64_C(0xbf58476d1ce4e5b9);
    z = (z ^ (z >> 27)) * UINT64_C(0x94d049bb133111eb);
    return z ^ (z >> 31);
}

static double uniform(double size) { return size * (2.0 * (double)(next() >> 11) * 0x1p-53 - 1.0); }

static double corner(double size) { return (next() & 1) ? size : -size; }

static int outside(double x) { return !(x <= 1.5 && x >= -1.5); }

int main(int argc, char **argv) {
    const uint64_t steps = argc > 1 ? strtoull(argv[1], NULL, 10) : 1000000;
    const double error = argc > 3 ? strtod(argv[3], NULL) : 0.0, range = argc > 4 ? strtod(argv[4], NULL) : 50.0;
    const double h = 0.05, wind = 0.2;
    const uint64_t steps_of_a_mood = 64;
    double p = 0.0, v = 0.0, push = 1.0, greatest_p = 0.0, greatest_v = 0.0;
    uint64_t left = 0, between = 0, unanswered = 0, changed = 0, mood = 0, i;
    state = argc > 2 ? strtoull(argv[2], NULL, 10) : 1;
    for (i = 0; i < steps; ++i) {
        double u, wish, w_p, w_v, middle;
        if (i % steps_of_a_mood == 0) {
            mood = next() % 4;
            push = corner(1.0);
        }
        /* Outwards with all its strength; back and forth; along the edge; anything. */
        wish = mood == 0 ? 50.0 * push : mood == 1 ? corner(50.0) : mood == 2 ? 3.0 * push - 2.0 * v : uniform(50.0);
        w_p = mood == 3 ? uniform(wind) : mood == 1 ? corner(wind) : wind * push;
        w_v = mood == 3 ? uniform(wind) : mood == 1 ? corner(wind) : wind * push;
        wish = fmax(-range, fmin(range, wish));
        if (!answer(p, v, wish, &u)) {
            ++unanswered;
            p = v = 0.0;
            continue;
        }
        if (u != wish) ++changed;
        if (u > 2.0) u = 2.0;
        if (u < -2.0) u = -2.0;
        u += mood == 3 ? uniform(error) : mood == 1 ? corner(error) : error * push;
        middle = p + 0.5 * h * (v + w_p) + 0.125 * h * h * (u + w_v);
        p += h * (v + w_p) + 0.5 * h * h * (u + w_v);
        v += h * (u + w_v);
        between += (uint64_t)outside(middle);
        left += (uint64_t)(outside(p) || outside(v));
        if (p > greatest_p) greatest_p = p;
        if (-p > greatest_p) greatest_p = -p;
        if (v > greatest_v) greatest_v = v;
        if (-v > greatest_v) greatest_v = -v;
    }
    printf("{\"steps\": %llu, \"left\": %llu, \"left_between\": %llu, \"unanswered\": %llu, \"changed\": %llu, "
           "\"greatest_p\": %.17g, \"greatest_v\": %.17g}\n",
           (unsigned long long)steps, (unsigned long long)left, (unsigned long long)between,
           (unsigned long long)unanswered, (unsigned long long)changed, greatest_p, greatest_v);
    return left + between + unanswered > 0 ? 1 : 0;
}
