"""A run within a total time: plan, options that follow from it, log and report, a kill, and what is too short. Times are not tested: other tests run
beside this one."""
import json

from harness import digest, expect, kill_group, main, metrics_of, small_survey, wait_for

QUICK = ["--blocks", "1x2", "--image-width", "160", "--set", "train.batch_samples=4096", "--set", "context.batch_samples=4096", "--set",
         "partition.max_log2_table_size=14", "--set", "products.video_seconds=1", "--set", "evaluate.max_photos=2"]


def ledger_of(project):
    try:
        return json.loads((project / ".state" / "within.json").read_text())
    except (OSError, json.JSONDecodeError):
        return {"stages": []}


def record(ledger, stage):
    return next((one for one in ledger["stages"] if one["stage"] == stage), {"begun": False, "changes": [], "took_s": 0.0})


def check_finished(project, within_s):
    """What log, plan.json, metrics and report say of a finished run."""
    plan, times, log = json.loads((project / "plan.json").read_text()), metrics_of(project)["times"], (project / "log.txt").read_text()
    expect(plan["within_s"] == within_s and times["within_s"] == within_s, f"other totals: {plan}, {times}")
    taken = {stage["stage"]: stage["took_s"] for stage in plan["stages"]}
    for stage in ("prepare", "partition", "train", "merge", "products", "evaluate"):
        expect(taken.get(stage) is not None, f"{stage} took no time: {taken}")
    expect(sum(time for time in taken.values() if time is not None) <= plan["used_s"] + 0.1, f"stages took more than all: {plan}")
    expect(plan["given_up"] == times["given_up"], f"{plan['given_up']} in the plan, {times['given_up']} in the report")
    for text in plan["given_up"]:
        expect(text in log, f"the log does not say that there is {text}")
    expect('id="time"' in (project / "report" / "index.html").read_text(), "the report has no times")
    return plan


def test(skyquilt, folder):
    survey = small_survey(skyquilt)

    plans = json.loads(skyquilt.call("plan", survey, "--within", "10s,10min", "--json", *QUICK[2:4]))
    expect([plan["within_s"] for plan in plans["plans"]] == [10, 600], plans)
    expect(plans["rates"]["samples"] > 1e4 and plans["photos"] > 3, plans)
    expect(plans["plans"][1]["training_s"] > plans["plans"][0]["training_s"] and not plans["plans"][1]["given_up"], plans)
    text = skyquilt.call("plan", survey, "--image-width", "160")
    expect(text.count("plan for") >= 2 and "memory for training" in text, text)
    skyquilt.call("plan", survey, "--memory", "20MB", status=2, says="at least")
    skyquilt.call("plan", folder / "nowhere", status=3)

    # Nothing is begun that cannot work.
    refused = folder / "refused"
    skyquilt.call("run", survey, "-o", refused, "--within", "20s", "--memory", "20MB", *QUICK, status=2, says="at least")
    expect(not (refused / "survey").exists(), "the run began all the same")

    project = folder / "project"
    words = ["run", survey, "-o", project, "--within", "20s", *QUICK]
    text = skyquilt.call(*words, says=("plan for 20.0s in all", "are used"))
    expect("rays/s" in text, "the speed of rendering was not measured")
    check_finished(project, 20)
    changes = dict(record(ledger_of(project), "train")["changes"])
    expect(float(changes["run.time_budget_s"]) > 1.0, f"training got {changes}")
    before = digest(project, but=("log.txt", "within.json", "plan.json"))
    skyquilt.call(*words, says="train: nothing to do")
    expect(digest(project, but=("log.txt", "within.json", "plan.json")) == before, "a finished run was made again")
    # Its options are in its configuration, so that later commands fit.
    skyquilt.call("evaluate", project, says="nothing to do")

    # Too short: what is not made is named, and the rest is made. Two photos are scored, though there is no time left.
    short = folder / "short"
    text = skyquilt.call("run", survey, "-o", short, "--within", "2s", *QUICK, "--set", "evaluate.max_photos=3", says="for 2.0s in all: ")
    plan = check_finished(short, 2)
    expect("2 of 3 held-out photos are scored" in plan["given_up"], f"given up: {plan['given_up']}")

    # A run that was killed goes on with its decisions, and its time counts.
    killed = folder / "killed"
    words = ["run", survey, "-o", killed, "--within", "25s", *QUICK]
    process = skyquilt.start(*words)
    wait_for(lambda: record(ledger_of(killed), "train")["took_s"] > 2.0, "some seconds of training", process)
    kill_group(process)
    left = ledger_of(killed)
    skyquilt.call(*words, says="of which")
    after = ledger_of(killed)
    expect(record(after, "train")["changes"] == record(left, "train")["changes"], "the resumed run decided anew")
    expect(after["used_s"] > left["used_s"] and record(after, "train")["took_s"] > record(left, "train")["took_s"], f"time was forgotten: {left}, {after}")
    check_finished(killed, 25)

    # The time of training alone keeps its meaning.
    given = folder / "given"
    skyquilt.call("run", survey, "-o", given, "--within", "1min", "--steps", "60", *QUICK)
    expect(not record(ledger_of(given), "train")["changes"], "the plan changed a training that was given")
    check_finished(given, 60)

    bench = folder / "bench"
    skyquilt.call("bench", "tradeoff", "--quick", "--survey", survey, "-o", bench, "--within", "8s", *QUICK[4:])
    results = json.loads((bench / "tradeoff.json").read_text())["results"]
    expect(len(results) == 1 and results[0]["wall_seconds"] > 0.0 and dict(results[0]["stage_seconds"])["train"] > 0.0, results)
    skyquilt.call("bench", "tradeoff", "--quick", "--survey", survey, "-o", bench, "--within", "8s", *QUICK[4:], says="its result is saved")
    skyquilt.call("bench", "tradeoff", "--survey", survey, "-o", bench, "--within", "soon", status=2)


main(test)
