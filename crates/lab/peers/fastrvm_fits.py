"""fastrvm on one problem a line of standard input: `NAME GAMMA`, the files as gen_data.py writes them.

    python fastrvm_fits.py DATADIR

Answers each with `fit_s nvec rmse evidence`: CPU seconds; relevance vectors; RMSE against the truth
without noise; and the log evidence, in nats, of the standardised targets at the fitted precisions
and noise. The bias counts as flat and is integrated out, whatever the package's own prior on it,
so that packages that treat it differently are measured by one rule. The precisions are taken from
the posterior, 1/(mean^2 + variance), which is what they are where the evidence is greatest: those
that the package names are of columns scaled otherwise.
"""
import os, sys, time
import numpy as np
from fastrvm import RVR
from sklearn.metrics.pairwise import rbf_kernel

def load(name, part):
    return np.loadtxt(os.path.join(sys.argv[1], f"{name}_{part}.csv"), delimiter=",", ndmin=2)

def evidence(phi, alpha, noise, y):
    """log N(y | 0, noise I + phi diag(1/alpha) phi') of what a flat bias leaves: all sums to 0."""
    n = len(y)
    phi = phi - phi.mean(0)
    covariance = noise*np.eye(n) + (phi/alpha) @ phi.T
    sign, logdet = np.linalg.slogdet(covariance)
    # The constant direction has the noise alone, and is the one left out.
    logdet -= np.log(noise)
    return -.5*((n-1)*np.log(2*np.pi) + logdet + y @ np.linalg.solve(covariance, y))

for line in sys.stdin:
    name, gamma = line.split()
    x, y, xt, yt = (load(name, part) for part in ("x", "y", "xt", "yt"))
    y, yt, gamma = y.ravel(), yt.ravel(), float(gamma)
    mean, scale = y.mean(), y.std()
    z = (y-mean)/scale
    start = time.process_time()
    model = RVR(kernel="rbf", gamma=gamma, fit_intercept=True).fit(x, z)
    seconds = time.process_time()-start
    rmse = np.sqrt(np.mean((model.predict(xt)*scale+mean-yt)**2))
    phi = rbf_kernel(x, x[model.relevance_], gamma)
    alpha = 1/(model.dual_coef_.ravel()**2 + np.diag(model.covariance_))
    log_evidence = evidence(phi, alpha, 1/model.beta_, z)
    print(seconds, model.n_relevance_, rmse, log_evidence, flush=True)
