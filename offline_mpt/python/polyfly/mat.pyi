from ._polyfly import Path, Program


def load_mat(path: Path) -> Program: ...
