"""Linear systems of the form [M J^T; J 0]: accelerations and multipliers of a mechanism."""

import numpy as np
from scipy import sparse
from scipy.sparse.linalg import splu

from ..core.quantities import Vector
from .tables import Evaluation

# From this number of unknowns on a sparse factorisation is faster.
SPARSE_FROM = 250


def solve_saddle(e: Evaluation, force: Vector, gamma: Vector) -> tuple[Vector, Vector]:
    """a and lambda of M a + J^T lambda = f, J a = gamma; LinAlgError where they are not unique."""
    size, m = force.size, gamma.size
    right = np.concatenate([force, gamma])
    if size + m < SPARSE_FROM:
        jacobian, matrix = e.held.jacobian, np.zeros((size + m, size + m))
        matrix[:size, :size], matrix[:size, size:], matrix[size:, :size] = e.mass, jacobian.T, jacobian
        solution = np.linalg.solve(matrix, right)
    else:
        held = make_sparse_jacobian(e)
        whole = sparse.bmat([[sparse.block_diag(list(e.blocks)), held.T], [held, None]], format="csc")
        try:
            solution = splu(whole).solve(right)
        except RuntimeError as error:  # "Factor is exactly singular"
            raise np.linalg.LinAlgError(str(error)) from error
    return solution[:size], solution[size:]


def make_sparse_jacobian(e: Evaluation) -> sparse.csr_matrix:
    """J with its entries alone."""
    m, size = e.held.value.size, e.force.size
    columns = 6 * (e.held.bodies[:, :, None] - 1) + np.arange(6)
    rows = np.broadcast_to(np.arange(m)[:, None, None], columns.shape)
    moving = np.broadcast_to(e.held.bodies[:, :, None] > 0, columns.shape)
    return sparse.csr_matrix((e.held.entries[moving], (rows[moving], columns[moving])), (m, size))
