from gaitdisc.results.provenance import installed_versions


def test_versions_name_what_computes_the_numbers():
    versions = installed_versions()
    assert {"gaitdisc", "python", "numpy", "torch", "ezc3d"} <= set(versions)
    assert all(versions.values())
