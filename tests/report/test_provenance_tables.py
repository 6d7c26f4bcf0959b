from gaitdisc.report.provenance_tables import flattened, provenance_rows, provenance_tables


def test_settings_become_rows():
    settings = {"a": {"b": [1, 2], "c": None}, "d": [{"e": 1}, {"e": 2}]}
    files = ["/home/someone/a.mot", "C:\\Users\\someone\\b.mot"]
    assert flattened({"files": files}) == [("files", "a.mot, b.mot")]
    assert flattened(settings) == [("a.b", "1, 2"), ("a.c", "None"), ("d.1.e", "1"), ("d.2.e", "2")]


def test_provenance(run):
    rows = dict(provenance_rows(run.provenance))
    assert rows["follows section"] == "4.2"
    assert rows["version of numpy"] == "2.4.6"


def test_every_page_has_the_same_three_tables(run):
    tables = provenance_tables(run.provenance)
    assert list(tables) == [table.name for table in tables.values()] == ["settings", "versions", "files"]
    assert tables["files"].rows == tuple(sorted(run.provenance.files.items()))
    assert tables["files"].caption == f"Files read, n = {len(run.provenance.files)}, with their SHA-256."
    assert tables["versions"].rows[0] == ("follows section", "4.2")
