#!/usr/bin/env python3
"""Ensembles of Debian's python3-emcee on one of the reference posteriors, for bench_samplers.

emcee_chains.py LIBRARY POSTERIOR FILE MOVES ENSEMBLES WALKERS WARMUP DRAWS THIN SEED STARTS OUT

The density is the compiled one of LIBRARY, called once for half an ensemble (vectorize=True), which is the cheapest way that emcee has. STARTS
holds the walkers' starts as doubles, (ensemble, walker, d). OUT gets the draws in natural units, (ensemble, walker, draw, quantity); standard
output the processor time of all ensembles with their warm-up, the number of evaluations and emcee's version. MOVES: stretch (emcee's default), de (differential evolution), or
snooker (that with a fifth of snooker moves, as emcee's documentation has for hard cases).
"""
import ctypes
import os
import sys
import time

os.environ["OMP_NUM_THREADS"] = os.environ["OPENBLAS_NUM_THREADS"] = "1"
import emcee  # noqa: E402
import numpy as np  # noqa: E402


def main():
    library, posterior, file, moves = sys.argv[1:5]
    ensembles, walkers, warmup, draws, thin, seed = map(int, sys.argv[5:11])
    lib = ctypes.CDLL(library)
    lib.open_posterior.restype = ctypes.c_void_p
    lib.evaluations.restype = ctypes.c_double
    lib.evaluations.argtypes = lib.dimension.argtypes = lib.quantities.argtypes = [ctypes.c_void_p]
    lib.log_densities.argtypes = lib.constrain.argtypes = [ctypes.c_void_p, ctypes.c_void_p, ctypes.c_int, ctypes.c_void_p]
    opened = lib.open_posterior(posterior.encode(), file.encode())
    d, m = lib.dimension(opened), lib.quantities(opened)
    starts = np.fromfile(sys.argv[11]).reshape(ensembles, walkers, d)

    def log_densities(x):
        x = np.ascontiguousarray(x)
        values = np.empty(len(x))
        lib.log_densities(opened, x.ctypes.data, len(x), values.ctypes.data)
        return values

    kinds = {"stretch": None, "de": emcee.moves.DEMove(), "snooker": [(emcee.moves.DEMove(), 0.8), (emcee.moves.DESnookerMove(), 0.2)]}
    quantities = np.empty((ensembles, walkers, draws, m))
    spent = 0.0
    for k in range(ensembles):
        np.random.seed(1000 * seed + k)
        sampler = emcee.EnsembleSampler(walkers, d, log_densities, moves=kinds[moves], vectorize=True)
        began = time.process_time()
        state = sampler.run_mcmc(starts[k], warmup, store=False)
        sampler.run_mcmc(state, draws, thin_by=thin)
        spent += time.process_time() - began
        chains = np.ascontiguousarray(sampler.get_chain().swapaxes(0, 1))  # (walker, draw, d)
        lib.constrain(opened, chains.ctypes.data, walkers * draws, quantities[k].ctypes.data)
    quantities.tofile(sys.argv[12])
    print(f"{spent} {int(lib.evaluations(opened))} {emcee.__version__}")


main()
