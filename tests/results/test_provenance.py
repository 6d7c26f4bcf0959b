from gaitdisc.results.provenance import code_sha256, installed_versions


def test_versions_name_what_computes_the_numbers():
    versions = installed_versions()
    assert {"gaitdisc", "python", "numpy", "torch", "ezc3d"} <= set(versions)
    assert all(versions.values())
    assert code_sha256()[:12] in versions["gaitdisc"]
