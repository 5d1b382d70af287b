"""`bench kernel` measures on any instruction set and says what it measured; how fast is no test's business. `bench numerics` leaves its page."""
import json

from harness import expect, main

SMALL = ["--seconds", "0.02", "--rounds", "1", "--log2-table-size", "10", "--batch", "2048"]


def test(skyquilt, folder):
    out = folder / "bench"
    for isa in ("portable", None):
        words = ["bench", "kernel", *SMALL, "-o", out] + (["--isa", isa] if isa else [])
        text = skyquilt.call(*words)
        expect("training" in text and "limit" in text, text)
        result = json.loads((out / "kernel.json").read_text())
        for key in ("isa", "threads", "train_samples_per_second", "infer_samples_per_second", "roofline_train_samples_per_second",
                    "roofline_fraction", "share", "config", "machine", "date"):
            expect(key in result, f"{key} is missing in kernel.json")
        expect(result["train_samples_per_second"] > 0.0 and result["roofline_train_samples_per_second"] > 0.0, result)
        expect(0.9 < sum(result["share"].values()) < 1.1, f"shares do not add up: {result['share']}")
        expect(result["config"]["log2_table_size"] == 10, result["config"])

    # On several ranks one process measures, the others stay quiet.
    text = skyquilt.call("bench", "kernel", *SMALL, "--threads", "1", ranks=2)
    expect(text.count("Where training time goes") == 1, text)

    # Numbers at the extremes: tables on the page, every row in the files, nothing left of what cases made.
    text = skyquilt.call("bench", "numerics", "--quick", "--only", "space,nonfinite,brightness", "-o", out)
    expect("Space" in text and "FAILED" not in text, text)
    result = json.loads((out / "numerics.json").read_text())
    expect(result["failed"] == 0 and result["passed"] > 30, result["passed"])
    page = (out / "numerics.html").read_text()
    rows = (out / "numerics_nonfinite.csv").read_text().splitlines()
    expect("How far rounding moves a place" in page and "North pole" in page, "the page lacks its plot or its rows")
    expect(rows[0] == "case,verdict,worst error,allowed,expected,seen" and len(rows) == 13, rows)
    expect(not (out / "work").exists(), "the folder of the cases' surveys is still there")


if __name__ == "__main__":
    main(test)
