#!/usr/bin/env python3
"""scikit-learn's part of bench_lasso: lasso_speed.py RAW ROWS COLUMNS; RAW holds A (column by column), b and the lambdas as doubles."""
import sys
import time

import numpy as np
from sklearn.linear_model import Lasso

n, m = int(sys.argv[2]), int(sys.argv[3])
raw = np.fromfile(sys.argv[1])
A, b, lambdas = raw[: n * m].reshape((n, m), order="F"), raw[n * m : n * m + n], raw[n * m + n :]
for tol in (1e-4, 1e-10):
    began = time.perf_counter()
    fit = Lasso(alpha=1.0, fit_intercept=False, warm_start=True, tol=tol, max_iter=1000000)
    for lam in lambdas:
        fit.set_params(alpha=lam / (2 * n)).fit(A, b)
    seconds = time.perf_counter() - began
    r = A @ fit.coef_ - b
    print(f"  scikit-learn  {seconds:8.3f} s  optimum at the last {r @ r + lambdas[-1] * np.abs(fit.coef_).sum():.12g}, tol {tol:g}", flush=True)
