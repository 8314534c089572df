#!/usr/bin/env python3
"""Optimal values of min |A z - b|^2 + lambda |z|_1 by scikit-learn, as CSV: the reference of lasso_test.cpp, which makes the same problems.

python3 lasso_reference.py > lasso_reference.csv
"""
import numpy as np
from sklearn.linear_model import Lasso


def problem(kind, n, m):
    i, j = np.arange(1.0, n + 1)[:, None], np.arange(1.0, m + 1)[None, :]
    a = np.cos(0.37 * i * j + 0.11 * j * j)
    if kind == "correlated":
        a = 0.05 * a + np.cos(0.2 * i + 0.01 * j)
    x = np.arange(1.0, n + 1)
    b = 3 + np.sin(0.21 * x) + 0.5 * np.cos(1.3 * x * x)
    return a, b


print("kind,rows,columns,intercept,lambda,objective")
for kind in ("oscillating", "correlated"):
    for n, m in ((60, 25), (50, 200), (120, 120)):
        a, b = problem(kind, n, m)
        for intercept in (False, True):
            ac, bc = (a - a.mean(0), b - b.mean()) if intercept else (a, b)
            top = 2 * np.abs(ac.T @ bc).max()
            for share in (0.5, 0.1, 0.01):
                lam = share * top
                fit = Lasso(alpha=lam / (2 * n), fit_intercept=False, tol=1e-12, max_iter=1000000).fit(ac, bc)
                z = fit.coef_
                r = ac @ z - bc
                print(f"{kind},{n},{m},{int(intercept)},{lam:.17g},{r @ r + lam * np.abs(z).sum():.17g}")
