def test_where_everybody_is_refused_the_exit_code_says_so(study, called, tmp_path):
    text = (study / "study.toml").read_text(encoding="utf-8").replace("min_strides = 10", "min_strides = 900")
    other = tmp_path / "study.toml"
    other.write_text(text.replace("../lab", str(study.parent / "lab")), encoding="utf-8")
    done = called("modalities", other, "--quiet")
    assert done.returncode == 1
    assert "refused: " in done.stderr
