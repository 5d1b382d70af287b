"""Videos as input: a simulated flight filmed with subtitles; its frames become photos with tags and poses. Then what goes wrong with videos: a kill while frames
are taken, a file that ends halfway or has no index, no ffmpeg, a camera without motion, a limit."""
import csv
import json
import math
import os
import shutil
import sys

from harness import expect, kill_group, main, shared, wait_for

NO_POSES = ["--set", "prepare.colmap=no-such-program"]  # ends after the frames, with status 3


def survey_of(project):
    return json.loads((project / "survey" / "survey.json").read_text())


def frames_of(project):
    """Without the hidden file that is being written."""
    return sorted(frame for frame in (project / "survey" / "frames").glob("*.jpg") if not frame.name.startswith("."))


def rows_of(project):
    with open(project / "survey" / "frames.csv", newline="") as table:
        return list(csv.DictReader(table))


def is_whole(jpeg):
    data = jpeg.read_bytes()
    return data[:2] == b"\xff\xd8" and data[-2:] == b"\xff\xd9"


def centre(rotation, translation):
    """Of a camera, from the transformation to its frame."""
    w, x, y, z = rotation
    rows = [[1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)], [2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)],
            [2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)]]
    return [-sum(rows[k][axis] * translation[k] for k in range(3)) for axis in range(3)]


def true_places(survey):
    with open(survey / "truth" / "video_poses.csv", newline="") as table:
        return {round(1000 * float(row["time_s"])): centre([float(row[f"rotation_{axis}"]) for axis in "wxyz"],
                                                            [float(row[f"translation_{axis}_m"]) for axis in "xyz"]) for row in csv.DictReader(table)}


def check_flight(skyquilt, survey, folder):
    """Tags, overlap and poses of the frames of a flight."""
    project = folder / "flight"
    skyquilt.call("prepare", survey / "video" / "flight.mp4", "-o", project, says=["subtitles from", "% overlap"])
    rows, found = rows_of(project), survey_of(project)
    expect([row["frame"] for row in rows] == [frame.name for frame in frames_of(project)], "frames.csv lists other frames than there are")
    overlaps = [float(row["overlap"]) for row in rows[1:-1]]
    expect(all(0.69 < overlap < 0.81 for overlap in overlaps), f"neighbours overlap by {overlaps}")
    expect(all("by place and height" in row["reason"] for row in rows[1:]), "frames were not chosen by the subtitles")
    expect(all(row["latitude_deg"] and row["relative_altitude_m"] and row["gimbal_pitch_deg"] for row in rows), "frames without tags")
    expect(len(found["photos"]) >= 0.95 * len(rows), f"{len(found['photos'])} of {len(rows)} frames have a pose")
    places = true_places(survey)
    # By the shape alone: where a flight this short is on Earth, its tags tell to decimetres.
    measured = [centre(photo["rotation_wxyz"], photo["translation_m"]) for photo in found["photos"]]
    truth = [places[int(photo["name"].split("_")[-1][:8])] for photo in found["photos"]]
    for i in range(1, len(truth)):
        wanted, got = math.dist(truth[i], truth[i - 1]), math.dist(measured[i], measured[i - 1])
        expect(abs(got - wanted) < 0.5 + 0.1 * wanted, f"{found['photos'][i]['name']} is {got:.2f} m from its neighbour, in truth {wanted:.2f} m")
    skyquilt.call("prepare", survey / "video" / "flight.mp4", "-o", project, says="up to date")
    # Another file beside the video is another input.
    changed = shutil.copytree(survey / "video", folder / "changed")
    skyquilt.call("prepare", changed, "-o", folder / "by_folder", *NO_POSES, status=3, says="subtitles from")
    expect([row["reason"] for row in rows_of(folder / "by_folder")] == [row["reason"] for row in rows], "the folder gives other frames than the file")


def check_kill(skyquilt, survey, folder):
    """A kill while frames are taken leaves whole frames; the same command finishes them."""
    dense = ["prepare", survey / "video" / "flight.mp4", "--set", "prepare.video_overlap=0.95", "--video-limit", "0", *NO_POSES]
    skyquilt.call(*dense, "-o", folder / "whole", status=3)
    whole = {frame.name: frame.read_bytes() for frame in frames_of(folder / "whole")}
    killed = folder / "killed"
    for least in (1, len(whole) // 2):
        process = skyquilt.start(*dense, "-o", killed)
        wait_for(lambda: len(frames_of(killed)) >= least, f"{least} frames", process)
        kill_group(process)
        expect(all(is_whole(frame) for frame in frames_of(killed)), "a kill left half a frame")
        expect(not (killed / "survey" / "frames.csv").exists() or len(frames_of(killed)) == len(whole), "the table is there before the frames")
    skyquilt.call(*dense, "-o", killed, status=3)
    expect(not list((killed / "survey" / "frames").glob(".*")), "an unfinished frame is left")
    expect({frame.name: frame.read_bytes() for frame in frames_of(killed)} == whole, "frames after kills differ from those of one go")
    skyquilt.call(*dense, "-o", killed, status=3, says="already taken")


def check_faults(skyquilt, survey, folder):
    video = survey / "video" / "flight.mp4"
    data = video.read_bytes()
    (folder / "cut").mkdir()
    cut = folder / "cut" / "flight.mp4"
    cut.write_bytes(data[:2 * len(data) // 3])
    shutil.copy(survey / "video" / "flight.SRT", folder / "cut")
    skyquilt.call("prepare", cut, "-o", folder / "of_cut", *NO_POSES, status=3, says="cut off or damaged")
    n_cut = len(frames_of(folder / "of_cut"))
    skyquilt.call("prepare", video, "-o", folder / "limited", "--video-limit", "4", *NO_POSES, status=3, says="Raise prepare.video_limit")
    expect(3 <= len(frames_of(folder / "limited")) <= 4, f"{len(frames_of(folder / 'limited'))} frames in spite of the limit")
    expect(n_cut >= 3, f"{n_cut} frames of two thirds of a video")
    cut.write_bytes(b"\0" * 5000)
    skyquilt.call("prepare", cut, "-o", folder / "of_nothing", status=3, says=["flight.mp4", "cannot be read as a video"])
    path, skyquilt.environment["PATH"] = skyquilt.environment["PATH"], os.fspath(folder)
    skyquilt.call("prepare", video, "-o", folder / "without", status=3, says="apt install ffmpeg")
    skyquilt.environment["PATH"] = path
    expect(not (folder / "without" / "survey" / "frames").exists(), "frames without ffmpeg")
    skyquilt.call("prepare", video, folder / "cut", "-o", folder / "both", status=2, says="not both")
    skyquilt.call("prepare", folder / "no.mp4", "-o", folder / "none", status=3, says="no such")


def test(skyquilt, folder):
    if shutil.which("ffmpeg") is None:
        print("skipped: no ffmpeg")
        sys.exit(77)
    survey = shared(skyquilt, "filmed_line", lambda made: skyquilt.call(
        "simulate", "hamlet", "-o", made, "--video", "--image-width", "240", "--set", "simulate.single_line=true"))
    check_flight(skyquilt, survey, folder)
    check_kill(skyquilt, survey, folder)
    check_faults(skyquilt, survey, folder)


if __name__ == "__main__":
    main(test)
