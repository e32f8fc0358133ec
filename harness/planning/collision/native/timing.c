/* TOPP-RA's passes, and states of timed paths; called through ctypes (library.py).

   Each function takes a table of arrays of doubles, in the order of its comment, and writes the last. */

#include "arrays.h"

/* Sine of an angle between lines up to which they have no intersection: rounding of directions. */
#define PARALLEL 1e-12

/* How much slower than possible each step of the second pass ends: at most [1/s^2], and as a share.
   At the largest rate itself only one acceleration is left, by which the motion may have to stop. */
#define LARGEST_RESERVE 1e-8
#define RESERVED_SHARE 1e-4

/* The bounds now x + after y <= room of a step. */
typedef struct {
    const double *now, *after, *room;
    int64_t count;
} Bounds;

/* The point of a step's polygon that has the largest x: a walk along the edges, counterclockwise
   from the origin, while x grows. */
static void find_peak(Bounds b, double *peak) {
    double x = 0.0, y = 0.0, along_x = 1.0, along_y = 0.0;
    while (along_x > PARALLEL) {
        double way = INFINITY;
        int64_t edge = 0;
        for (int64_t k = 0; k < b.count; ++k) {
            double speed = b.now[k] * along_x + b.after[k] * along_y;
            double left = largest_of(b.room[k] - b.now[k] * x - b.after[k] * y, 0.0);
            if (speed > PARALLEL && left / speed < way) way = left / speed, edge = k;
        }
        x += way * along_x, y += way * along_y;
        along_x = -b.after[edge], along_y = b.now[edge];
    }
    peak[0] = x, peak[1] = y;
}

/* The largest value of the coordinate that has the factors `of`, at a value of the other one. */
static double largest_at(double other, const double *of, const double *factors, Bounds b) {
    double most = INFINITY;
    for (int64_t k = 0; k < b.count; ++k)
        if (of[k] > PARALLEL) most = least_of(most, b.room[k] / of[k] - factors[k] / of[k] * other);
    return most;
}

/* now, after, room: (N, m); the largest squared rates (N + 1,), at rest at both ends. */
void squared_rates(const Array *t) {
    const double *now = t[0].data, *after = t[1].data, *room = t[2].data;
    double *found = t[3].data, peak[2];
    int64_t steps = t[0].shape[0], count = t[0].shape[1];
    found[steps] = 0.0;
    for (int64_t row = steps - 1; row >= 0; --row) {
        Bounds b = {now + row * count, after + row * count, room + row * count, count};
        find_peak(b, peak);
        found[row] = peak[1] <= found[row + 1]
                         ? peak[0]
                         : largest_of(0.0, largest_at(found[row + 1], b.now, b.after, b));
    }
    found[0] = 0.0;
    for (int64_t row = 0; row < steps; ++row) {
        Bounds b = {now + row * count, after + row * count, room + row * count, count};
        double reached = least_of(found[row + 1], largest_at(found[row], b.after, b.now, b));
        reached -= least_of(LARGEST_RESERVE, RESERVED_SHARE * reached);
        found[row + 1] = largest_of(0.0, reached); /* rounding may leave less than nothing */
    }
}

/* The last of `count` intervals, next to a known one, that begins at or before a value. */
static int64_t interval_of(double value, const double *begins, int64_t count, int64_t known) {
    while (known > 0 && begins[known] > value) --known;
    while (known + 1 < count && begins[known + 1] <= value) ++known;
    return known;
}

/* times (M,); of each step: its time, parameter and rate, (S + 1,) each, and growth (S,); of each
   piece of the path: its first parameter (K + 1,), origin (K, 2), and coefficients from the cubic
   on, (K, dof) each; the least and largest parameter, and how near below a piece belongs to it;
   positions, velocities, accelerations (3, M, dof). */
void timed_states(const Array *t) {
    const double *times = t[0].data, *ends = t[1].data, *grid = t[2].data, *rates = t[3].data;
    const double *growths = t[4].data, *begins = t[5].data, *origins = t[6].data;
    const double *cubic = t[7].data, *square = t[8].data, *slope = t[9].data, *value = t[10].data;
    const double *range = t[11].data;
    int64_t count = t[0].shape[0], dof = t[7].shape[1], step = 0, piece = 0;
    double *positions = t[12].data, *velocities = positions + count * dof;
    double *accelerations = velocities + count * dof;
    for (int64_t i = 0; i < count; ++i) {
        step = interval_of(times[i], ends, t[4].shape[0], step);
        double since = times[i] - ends[step], growth = growths[step];
        double s = grid[step] + since * rates[step] + 0.5 * (since * since) * growth;
        double rate = rates[step] + since * growth;
        s = clamped(s, range[0], range[1]);
        piece = interval_of(s + range[2], begins, t[7].shape[0], piece);
        double u = s - origins[2 * piece] + origins[2 * piece + 1], u2 = u * u;
        for (int64_t j = piece * dof, out = i * dof; j < (piece + 1) * dof; ++j, ++out) {
            double first = slope[j] + square[j] * u * 2 + cubic[j] * u2 * 3;
            double second = square[j] * 2 + cubic[j] * u * 6;
            positions[out] = value[j] + slope[j] * u + square[j] * u2 + cubic[j] * (u2 * u);
            velocities[out] = first * rate;
            accelerations[out] = second * (rate * rate) + first * growth;
        }
    }
}

/* times (2 M,), the second half a window earlier; the times of knots (K,), and the integral, positions
   and velocities there, (K, dof) each; positions and velocities at the times, (2 M, dof) each; the
   time between knots and the window; their means over the window, and the mean's rates (3, M, dof). */
void window_means(const Array *t) {
    const double *times = t[0].data, *knots = t[1].data, *sums = t[2].data, *at = t[3].data;
    const double *rates = t[4].data, *positions = t[5].data, *velocities = t[6].data;
    const double *lengths = t[7].data;
    int64_t last = t[1].shape[0] - 1, count = t[8].shape[1], dof = t[8].shape[2];
    for (int64_t i = 0; i < 2 * count; ++i) {
        double inside = clamped(times[i], 0.0, knots[last]);
        int64_t low = (int64_t)(inside / lengths[0]);
        if (low >= last) low = last - 1;
        double rest = inside - knots[low];
        int is_moving = times[i] > 0.0 && times[i] < knots[last];
        for (int64_t j = 0; j < dof; ++j) {
            double here = positions[i * dof + j], rate = is_moving ? velocities[i * dof + j] : 0.0;
            double sum = sums[low * dof + j] + 0.5 * rest * (at[low * dof + j] + here) +
                         rest * rest / 12 * (rates[low * dof + j] - rate) + (times[i] - inside) * here;
            double values[] = {sum, here, rate};
            for (int k = 0; k < 3; ++k) {
                double *found = (double *)t[8].data + (k * count + i % count) * dof + j;
                *found = i < count ? values[k] : (*found - values[k]) / lengths[1];
            }
        }
    }
}

/* times (N,); positions, velocities, accelerations (N, dof) each; the limits of the latter two, and
   of accelerations on the cubics between states, (dof,) each; the largest shares of these (3,). */
void largest_shares(const Array *t) {
    const double *times = t[0].data, *p = t[1].data, *v = t[2].data, *a = t[3].data;
    const double *fastest = t[4].data, *hardest = t[5].data, *between = t[6].data;
    double *found = t[7].data;
    int64_t count = t[1].shape[0], dof = t[1].shape[1];
    for (int k = 0; k < 3; ++k) found[k] = 0.0;
    for (int64_t i = 0; i < count * dof; ++i) {
        int64_t j = i % dof, next = i + dof;
        found[0] = largest_of(fabs(v[i]) / fastest[j], found[0]);
        found[1] = largest_of(fabs(a[i]) / hardest[j], found[1]);
        if (next >= count * dof) continue;
        double step = times[i / dof + 1] - times[i / dof], mean = (p[next] - p[i]) / step;
        double first = (6.0 * mean - 4.0 * v[i] - 2.0 * v[next]) / step;
        double last = (-6.0 * mean + 2.0 * v[i] + 4.0 * v[next]) / step;
        found[2] = largest_of(largest_of(fabs(first), fabs(last)) / between[j], found[2]);
    }
}
