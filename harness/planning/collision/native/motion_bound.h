/* Poses of the moving joints, and bounds of the motion of bodies over an interval. */
#ifndef MOTION_BOUND_H
#define MOTION_BOUND_H

#include "arrays.h"

/* A moving joint: its pose on its parent at zero (12), its axis (3), 1 if it is prismatic. */
typedef double Joint[16];

/* How a ball moves while the joints that carry it move by their rates. */
typedef struct {
    double centre[3];   /* first-order motion of the centre [m] */
    double rotation[3]; /* rotation vector [rad] */
    double radius;
    double second;      /* a bound of all other motion of its points: second order, strays [m] */
    double all;         /* a bound of all motion of its points [m] */
} BodyMotion;

/* How two bodies move over an interval, in the frame of the second. */
typedef struct {
    double centres[3];      /* first-order motion of one centre relative to the other [m] */
    double rotations[2][3]; /* rotation vectors [rad] */
    double radii[2];
    double second;          /* a bound of all other motion [m] */
    double all;             /* a bound of all motion [m] */
} PairMotion;

/* Poses of the moving joints in the world at their values; a parent comes before its children. */
static void joint_poses(const double *values, const int64_t *parent, const Joint *chain,
                        int64_t count, Transform *out) {
    for (int64_t m = 0; m < count; ++m) {
        Transform fixed;
        const double *axis = chain[m] + 12;
        double q = values[m];
        if (parent[m] >= 0)
            compose(out[parent[m]], chain[m], fixed);
        else
            copy(chain[m], fixed, 12);
        if (chain[m][15] > 0.5) { /* prismatic */
            copy(fixed, out[m], 9);
            for (int i = 0; i < 3; ++i) out[m][9 + i] = fixed[9 + i] + dot(fixed + 3 * i, axis) * q;
            continue;
        }
        double x = axis[0], y = axis[1], z = axis[2];
        double c = cos(q), s = sin(q), v = 1.0 - c;
        Transform turned = {c + x * x * v,     x * y * v - z * s, x * z * v + y * s,
                            x * y * v + z * s, c + y * y * v,     y * z * v - x * s,
                            x * z * v - y * s, y * z * v + x * s, c + z * z * v};
        compose(fixed, turned, out[m]);
    }
}

/* How a ball moves when the joints from `path` to `end`, listed tip first, move by their rates and
   stray from that.

   `out` has an entry for each number of joints from the tip on that move; the first one, of none,
   is zero. */
static void body_motion(const double *rates, const double *strays, const uint32_t *path,
                        const uint32_t *end, const Joint *chain, const Transform *poses,
                        const double *centre, double radius, BodyMotion *out) {
    double moved = 0.0, distal = 0.0, second = 0.0;
    double centre_motion[3] = {0.0, 0.0, 0.0}, rotation[3] = {0.0, 0.0, 0.0};
    for (; path < end; ++path) {
        double rate = rates[*path], stray = strays[*path], w = fabs(rate) + stray;
        const double *pose = poses[*path];
        double axis[3];
        rotate(pose, chain[*path] + 12, axis);
        if (chain[*path][15] > 0.5) { /* prismatic */
            for (int i = 0; i < 3; ++i) centre_motion[i] += rate * axis[i];
            moved += w;
            distal += w;
            second += 2.0 * stray;
        } else {
            double arm[3], turn[3];
            subtract(centre, pose + 9, arm);
            cross(axis, arm, turn);
            for (int i = 0; i < 3; ++i) {
                centre_motion[i] += rate * turn[i];
                rotation[i] += rate * axis[i];
            }
            double lever = length_of(arm) + radius + moved, reach = length_of(turn) + radius;
            moved += w * (reach + moved);
            second += w * (3.0 * distal + w * lever) + 2.0 * stray * reach;
            distal += w * lever;
        }
        ++out;
        copy(centre_motion, out->centre, 3);
        copy(rotation, out->rotation, 3);
        out->radius = radius;
        out->second = 0.5 * second;
        out->all = moved;
    }
}

/* How much nearer two bodies come at most along a unit vector, over the interval.

   The points of a moving ball move along the vector by the motion of its centre, its rotation times
   the radius, and second-order terms; never by more than the bound of all motion. */
static inline double motion_along(const PairMotion *motion, const double *direction) {
    double turn[3], along = fabs(dot(motion->centres, direction)) + motion->second;
    for (int side = 0; side < 2; ++side) {
        cross(direction, motion->rotations[side], turn);
        along += length_of(turn) * motion->radii[side];
    }
    return least_of(along, motion->all);
}

/* The motion of two bodies relative to each other; `base` is the pose of the second body. */
static void pair_motion(const BodyMotion *near, const BodyMotion *far, const double *base,
                        PairMotion *out) {
    double centre[3];
    subtract(near->centre, far->centre, centre);
    rotate_back(base, centre, out->centres);
    rotate_back(base, near->rotation, out->rotations[0]);
    rotate_back(base, far->rotation, out->rotations[1]);
    out->radii[0] = near->radius;
    out->radii[1] = far->radius;
    out->second = near->second + far->second;
    out->all = near->all + far->all;
}

#endif
