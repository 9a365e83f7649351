/* One period of a train after the other, with its outputs at equal distances: RODAS, an L-stable Rosenbrock
   method of order 4 with an estimate of order 3 (Hairer and Wanner, Solving ODEs II, IV.7).

   For hosts without a library, such as a browser: what they set and read are arrays of fixed sizes. */
#include <stdbool.h>
#include <stdint.h>

#include "kernels.h"
#include "sizes.h"

#define N STATES
#define STAGES 6
#define GAMMA 0.25
/* A step grows or shrinks by no more than this, and aims at this share of the error allowed. */
#define LARGEST 5.0
#define SMALLEST 0.2
#define SAFETY 0.9
/* Of a period, below which a step makes no progress. */
#define HOPELESS 1e-12
/* Of a period, beyond which a page would seem dead; some need 50 000. */
#define MOST_STEPS 500000
/* The root of what a double resolves. */
#define DIFFERENCE 1.5e-8

#define CALL(kernel, ...) kernel_##kernel(&(int64_t){0}, &(void *){0}, __VA_ARGS__)

double parameters[PARAMETERS + 1], inputs[INPUTS + 1], state[N], start[N], nominal[N];
double rows[(SAMPLES + 1) * OUTPUTS];
/* By state: whether each period begins it at its start, and whether it must stay above zero. */
int32_t held[N], positive[N];
static double begun[N]; /* the state at the begin of the last period */

static const double A[STAGES][STAGES] = {
    {0},
    {1.544},
    {0.9466785280815826, 0.2557011698983284},
    {3.314825187068521, 2.896124015972201, 0.9986419139977817},
    {1.221224509226641, 6.019134481288629, 12.53708332932087, -0.6878860361058950},
    {1.221224509226641, 6.019134481288629, 12.53708332932087, -0.6878860361058950, 1.0}};
static const double C[STAGES][STAGES] = {
    {0},
    {-5.6688},
    {-2.430093356833875, -0.2063599157091915},
    {-0.1073529058151375, -9.594562251023355, -20.47028614809616},
    {7.496443313967647, -10.24680431464352, -33.99990352819905, 11.70890893206160},
    {8.083246795921522, -7.981132988064893, -31.52159432874371, 16.31930543123136, -6.058818238834054}};
static const double SHARE[STAGES] = {0.0, 0.386, 0.21, 0.63, 1.0, 1.0};

static double rate[N], next[N], changed[N], K[STAGES][N];
static double jacobian[N][N], matrix[N][N];
static int pivot[N];
static bool moving[N];

static double magnitude(double x)
{
    return x < 0.0 ? -x : x;
}

static void find_rate(double t, const double *x, double *dx)
{
    CALL(derivative, t, x, inputs, parameters, dx);
}

static void differentiate(double t, int column)
{
    double kept = next[column], moved = kept + DIFFERENCE * (nominal[column] + magnitude(kept));
    next[column] = moved;
    find_rate(t, next, changed);
    next[column] = kept;
    for (int i = 0; i < N; i++) jacobian[i][column] = (changed[i] - rate[i]) / (moved - kept);
    moving[column] = true;
}

/* Columns of the states that move, and of those that they move. */
static void find_jacobian(double t)
{
    bool more = true;
    for (int i = 0; i < N; i++) {
        next[i] = state[i];
        moving[i] = false;
        for (int j = 0; j < N; j++) jacobian[i][j] = 0.0;
    }
    for (int i = 0; i < N; i++)
        if (rate[i] != 0.0) differentiate(t, i);
    while (more) {
        more = false;
        for (int i = 0; i < N; i++)
            for (int j = 0; j < N && !moving[i]; j++)
                if (jacobian[i][j] != 0.0) {
                    differentiate(t, i);
                    more = true;
                }
    }
}

static void factorise(double h)
{
    for (int i = 0; i < N; i++)
        for (int j = 0; j < N; j++) matrix[i][j] = (i == j ? 1.0 / (GAMMA * h) : 0.0) - jacobian[i][j];
    for (int c = 0; c < N; c++) {
        pivot[c] = c;
        for (int i = c + 1; i < N; i++)
            if (magnitude(matrix[i][c]) > magnitude(matrix[pivot[c]][c])) pivot[c] = i;
        for (int j = 0; j < N && pivot[c] != c; j++) {
            double kept = matrix[c][j];
            matrix[c][j] = matrix[pivot[c]][j];
            matrix[pivot[c]][j] = kept;
        }
        for (int i = c + 1; i < N; i++) {
            if (matrix[i][c] == 0.0) continue;
            double factor = matrix[i][c] /= matrix[c][c];
            for (int j = c + 1; j < N; j++) matrix[i][j] -= factor * matrix[c][j];
        }
    }
}

static void solve(double *b)
{
    for (int c = 0; c < N; c++) {
        double kept = b[pivot[c]];
        b[pivot[c]] = b[c];
        b[c] = kept;
    }
    for (int i = 0; i < N; i++)
        for (int j = 0; j < i; j++) b[i] -= matrix[i][j] * b[j];
    for (int i = N - 1; i >= 0; i--) {
        for (int j = i + 1; j < N; j++) b[i] -= matrix[i][j] * b[j];
        b[i] /= matrix[i][i];
    }
}

/* The state after a step, in `next`, and its error, of which 1 is allowed; NaN where it is no state. */
static double try_step(double t, double h, double tolerance)
{
    double sum = 0.0;
    factorise(h);
    for (int s = 0; s < STAGES; s++) {
        for (int i = 0; i < N; i++) {
            next[i] = state[i];
            for (int q = 0; q < s; q++) next[i] += A[s][q] * K[q][i];
        }
        if (s) find_rate(t + SHARE[s] * h, next, K[s]);
        for (int i = 0; i < N; i++) {
            if (!s) K[s][i] = rate[i];
            for (int q = 0; q < s; q++) K[s][i] += C[s][q] * K[q][i] / h;
        }
        solve(K[s]);
    }
    for (int i = 0; i < N; i++) {
        double error = K[STAGES - 1][i], share = error / (tolerance * (nominal[i] + magnitude(state[i])));
        next[i] += error;
        if (positive[i] && !(next[i] > 0.0)) return __builtin_nan("");
        sum += share * share;
    }
    return __builtin_sqrt(sum / N);
}

/* Computes a period, whose outputs are the rows. Returns its largest change of a state that no period begins at
   its start, over nominal + |value|; NaN where no step succeeds, or too many are needed. */
double revolve(double period, double tolerance)
{
    double t = 0.0, h = period / SAMPLES, change = 0.0;
    bool stale = true;
    int steps = 0;
    for (int i = 0; i < N; i++) begun[i] = state[i] = held[i] ? start[i] : state[i];
    CALL(output, t, state, inputs, parameters, rows);
    for (int k = 1; k <= SAMPLES;) {
        if (++steps > MOST_STEPS) return __builtin_nan("");
        double target = period * k / SAMPLES, left = target - t;
        bool last = h >= left;
        double length = last ? left : h;
        if (stale) {
            find_rate(t, state, rate);
            find_jacobian(t);
        }
        double error = try_step(t, length, tolerance);
        double factor = SAFETY / __builtin_sqrt(__builtin_sqrt(error > 1e-8 ? error : 1e-8));
        factor = !(factor > SMALLEST) ? SMALLEST : factor > LARGEST ? LARGEST : factor;
        if (error != error) factor = SMALLEST;
        stale = error <= 1.0;
        if (!stale) {
            h = length * factor;
            if (!(h > HOPELESS * period)) return __builtin_nan("");
            continue;
        }
        t = last ? target : t + length;
        if (!last || length * factor > h) h = length * factor;
        for (int i = 0; i < N; i++) state[i] = next[i];
        if (last) CALL(output, t, state, inputs, parameters, rows + OUTPUTS * k++);
    }
    for (int i = 0; i < N; i++) {
        double moved = magnitude(state[i] - begun[i]) / (nominal[i] + magnitude(begun[i]));
        if (!held[i] && moved > change) change = moved;
    }
    return change;
}
