"""What a browser's Python lacks: the methods work without it, only slower."""

import subprocess
import sys

LACKS = ("anywidget", "ipywidgets", "joblib", "matplotlib", "numba", "pymunk", "sklearn")
PROGRAM = f"""
import sys

class Missing:
    def find_spec(self, name, path=None, target=None):
        if name.split(".")[0] in {LACKS}:
            raise ModuleNotFoundError(name)

sys.meta_path.insert(0, Missing())
import arkaq_edu as ae
import numpy as np

kf = ae.KalmanFilter([[1]], [[1]], [[1]], [[1]])
print("kalman", kf.filter(np.full((9, 1), 4.0)).x[-1].round(1))
print("art", ae.EuclideanART(0.5).fit([[0.0, 0.0], [1.0, 1.0], [0.1, 0.0]]).predict([[1.0, 1.0]]))
print("art1", ae.ART1(0.5).fit(np.eye(3)).n_clusters_, ae.ART2A(0.9, 0.1).fit(np.eye(2)).labels_)
print("mdp", ae.value_iteration(ae.mdp.example_mdp())[1])
learner = ae.QLearner(2, 2, 0.5, 0.9)
learner.update(0, 1, 8.0, 1, True)
print("q", learner.Q[0])
tiger = ae.pomdp.problem("tiger")
print("pomdp", ae.belief_update(tiger, tiger.start, 0, 0), len(ae.solve_pomdp(tiger, horizon=2)))
try:
    ae.EuclideanART(0.5).predict([[1.0]])
except ValueError as error:
    print("not fitted" in str(error))
for rows in ([[1.0]], [[1.0, np.nan]]):
    try:
        ae.EuclideanART(0.5).fit([[0.0, 0.0]]).predict(rows)
    except ValueError as error:
        print(str(error)[:9])
"""


def test_the_methods_work_without_numba_scikit_learn_and_joblib():
    run = subprocess.run([sys.executable, "-c", PROGRAM], capture_output=True, text=True)
    assert run.stderr == ""
    assert (
        run.stdout.splitlines()
        == subprocess.run(
            [sys.executable, "-c", PROGRAM.replace(str(LACKS), "()")],
            capture_output=True,
            text=True,
        ).stdout.splitlines()
    )
