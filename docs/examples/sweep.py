"""Let the ball of the laboratory hit the sand with five speeds."""

import rockshed

peaks = {}
for speed in (2.0, 4.0, 6.0, 8.0, 10.0):
    system = rockshed.case("lab-impact", values={"rock.velocity0.y": -speed}, stop_time=0.02)
    run = rockshed.simulate(system)
    peaks[speed] = run.metrics["peak_transmitted_force"].value
    print(f"{speed:4.0f} m/s  {peaks[speed] / 1e3:6.2f} kN")

figure = run.plot("sand.transmitted_force", "sand.rock.force.y")
figure.savefig("sweep.png")
