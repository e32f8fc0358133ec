/* Whether two trees of convex sets keep a distance over an interval. */
#ifndef TREE_DISTANCE_H
#define TREE_DISTANCE_H

#include "convex_distance.h"

/* Answers about a pair over an interval: free throughout, free at the middle state, undecided and
   blocked there. */
enum { FREE, CLEAR_STATE, UNDECIDED, BLOCKED };

/* The size of two nodes, relative to an interval's motion bound, below which they are not refined:
   a shorter interval costs less. Nodes that are apart are not refined for the motion's sake either. */
static const double GIVE_UP = 0.7;

/* The largest number of pairs of nodes that wait for comparison; beyond it Coal decides. */
enum { MOST_WAITING = 1024 };

typedef struct {
    int64_t first, second;
} NodePair;

/* Put the pairs of a node's children with another node on the stack; 0 where it is full. */
static int push_children(const Tree *tree, NodePair pair, int is_first, NodePair *stack,
                         int *waiting) {
    int64_t node = is_first ? pair.first : pair.second;
    for (int64_t child = node + 1; child < tree->nodes[node][0]; child = tree->nodes[child][0]) {
        if (*waiting >= MOST_WAITING) return 0;
        stack[(*waiting)++] = is_first ? (NodePair){child, pair.second} : (NodePair){pair.first, child};
    }
    return 1;
}

/* Whether two trees keep a distance over an interval and at its middle state.

   `root` has the roots of the trees, of which the first is placed at T in the frame of the other.
   A state is free above the distance `free`, and blocked below `blocked`. `motion` is null where
   the interval is its middle state alone. `axis` is the direction of the last separating plane. */
static int compare_trees(const Tree *tree, const Tree *other, NodePair root, const double *T,
                         double free, double blocked, const PairMotion *motion, double *axis) {
    NodePair stack[MOST_WAITING];
    int waiting = 1, answer = FREE;
    stack[0] = root;
    while (waiting > 0) {
        NodePair pair = stack[--waiting];
        const double *ball = tree->spheres[pair.first], *far_ball = other->spheres[pair.second];
        double step[3];
        apply(T, ball, step);
        subtract(step, far_ball, step);
        double gap = length_of(step), size = ball[3] + far_ball[3];
        if (gap - size > free) {
            if (!motion || gap - size - motion->all > free) continue;
            double direction[3] = {step[0] / gap, step[1] / gap, step[2] / gap};
            if (gap - size - motion_along(motion, direction) > free) continue;
        }
        int64_t a = tree->nodes[pair.first][1], b = other->nodes[pair.second][1];
        int is_leaf = tree->nodes[pair.first][0] == pair.first + 1;
        int is_far_leaf = other->nodes[pair.second][0] == pair.second + 1;
        int is_exact = is_leaf && is_far_leaf;
        if (a >= 0 && b >= 0) {
            double *direction = pair.first == root.first && pair.second == root.second ? axis : step;
            if (direction[0] == 0.0 && direction[1] == 0.0 && direction[2] == 0.0) {
                copy(step, direction, 3);
                if (gap == 0.0) direction[0] = 1.0;
            }
            Bounds bounds = distance_bounds(tree, other, (uint32_t)a, (uint32_t)b, T, motion, free,
                                            is_exact ? blocked : -INFINITY, direction);
            if (bounds.ahead > free) continue;
            if (is_exact) {
                if (bounds.most < blocked) return BLOCKED;
                motion = 0;
                int state = bounds.least > free ? CLEAR_STATE : UNDECIDED;
                if (state > answer) answer = state;
                continue;
            }
            if (motion && (bounds.least > free || size < GIVE_UP * motion->all)) {
                motion = 0;
                if (answer < CLEAR_STATE) answer = CLEAR_STATE;
            }
            if (!motion && bounds.least > free) continue;
        }
        int splits_first = is_far_leaf || (!is_leaf && ball[3] >= far_ball[3]);
        if (!push_children(splits_first ? tree : other, pair, splits_first, stack, &waiting))
            return UNDECIDED;
    }
    return answer;
}

#endif
