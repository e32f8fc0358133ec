/* Efforts of a tree of joints by the recursive Newton-Euler algorithm, two states at a time;
   called through ctypes (library.py). The vectors of a link are in the frame of the joint that moves it. */

#include "arrays.h"

enum { STATES = 2, PARENT_JOINT = 16, MASS, FIRST_MOMENT, INERTIA = 21, WIDTH = 27 };
typedef double Pair __attribute__((vector_size(STATES * sizeof(double))));

/* Pose on the parent; angular velocity and acceleration, acceleration of the origin less gravity;
   the force on the link and all that it carries, and the moment about the origin. */
typedef struct {
    Pair turn[9], at[3], spin[3], growth[3], pull[3], force[3], moment[3];
} Link;

#define EACH(i) for (int i = 0; i < 3; ++i)
#define ROW(T, i, v) (T[3 * (i)] * v[0] + T[3 * (i) + 1] * v[1] + T[3 * (i) + 2] * v[2])
#define COLUMN(T, i, v) (T[i] * v[0] + T[(i) + 3] * v[1] + T[(i) + 6] * v[2])
#define CROSS(a, b, i) (a[(i + 1) % 3] * b[(i + 2) % 3] - a[(i + 2) % 3] * b[(i + 1) % 3])

/* Move a link on its parent by the joint's value, rate and acceleration; the forces on it alone. */
static void move_link(const double *joint, const Pair *by, const Link *up, Link *link) {
    const double *axis = joint + 12, *h = joint + FIRST_MOMENT, *n = joint + INERTIA;
    const double inertia[] = {n[0], n[1], n[3], n[1], n[2], n[4], n[3], n[4], n[5]};
    double x = axis[0], y = axis[1], z = axis[2], slides = joint[15], turns = 1.0 - slides;
    Pair *spin = link->spin, *growth = link->growth, *pull = link->pull;
    Pair c, s, swept[3], step[3], carried[3], momentum[3];
    for (int k = 0; k < STATES; ++k) c[k] = cos(turns * by[0][k]), s[k] = sin(turns * by[0][k]);
    Pair v = 1.0 - c, columns[] = {c + x * x * v,     x * y * v + z * s, x * z * v - y * s,
                                   x * y * v - z * s, c + y * y * v,     y * z * v + x * s,
                                   x * z * v + y * s, y * z * v - x * s, c + z * z * v};
    EACH(i) EACH(j) link->turn[3 * i + j] = ROW(joint, i, (columns + 3 * j));
    EACH(i) link->at[i] = joint[9 + i] + slides * ROW(joint, i, axis) * by[0];
    EACH(i) swept[i] = CROSS(up->spin, link->at, i), step[i] = axis[i] * by[1];
    EACH(i) carried[i] = up->pull[i] + CROSS(up->growth, link->at, i) + CROSS(up->spin, swept, i);
    EACH(i) spin[i] = COLUMN(link->turn, i, up->spin);
    EACH(i) {
        Pair whirl = CROSS(spin, step, i), own = axis[i] * by[2];
        growth[i] = COLUMN(link->turn, i, up->growth) + turns * (whirl + own);
        pull[i] = COLUMN(link->turn, i, carried) + slides * (2.0 * whirl + own);
    }
    EACH(i) spin[i] += turns * step[i];
    EACH(i) swept[i] = CROSS(spin, h, i), momentum[i] = ROW(inertia, i, spin);
    EACH(i) {
        link->force[i] = joint[MASS] * pull[i] + CROSS(growth, h, i) + CROSS(spin, swept, i);
        link->moment[i] = ROW(inertia, i, growth) + CROSS(h, pull, i) + CROSS(spin, momentum, i);
    }
}

/* joints (M, 27): a Joint, the parent or -1, and Pinocchio's dynamic parameters of what it carries;
   gravity (3,); positions, velocities and accelerations (3, N, M); the efforts (N, M). */
void efforts(const Array *t) {
    const double *joints = t[0].data, *gravity = t[1].data, *states = t[2].data;
    double *found = t[3].data;
    int64_t width = t[0].shape[0], count = t[3].shape[0];
    Link links[width + 1]; /* after the base */
    for (int64_t state = 0; state < count; state += STATES) {
        links[0] = (Link){0};
        EACH(i) links[0].pull[i] -= gravity[i];
        for (int64_t m = 0; m < width; ++m) {
            Pair by[3];
            EACH(i) for (int64_t k = 0; k < STATES; ++k)
                by[i][k] = states[(i * count + state + (state + k < count) * k) * width + m];
            const double *joint = joints + WIDTH * m;
            move_link(joint, by, links + 1 + (int64_t)joint[PARENT_JOINT], links + 1 + m);
        }
        for (int64_t m = width - 1; m >= 0; --m) {
            const double *joint = joints + WIDTH * m;
            Link *link = links + 1 + m, *up = links + 1 + (int64_t)joint[PARENT_JOINT];
            Pair force[3], *along = joint[15] > 0.5 ? link->force : link->moment;
            Pair effort = ROW(along, 0, (joint + 12));
            for (int k = 0; k < STATES && state + k < count; ++k)
                found[(state + k) * width + m] = effort[k];
            EACH(i) up->force[i] += force[i] = ROW(link->turn, i, link->force);
            EACH(i) up->moment[i] += ROW(link->turn, i, link->moment) + CROSS(link->at, force, i);
        }
    }
}
