"""A speed controller drives the servo, with three wheels: one file NAME.fmu, its parameter set before each run."""

from shutil import rmtree

from fmpy import extract, read_model_description
from fmpy.fmi2 import FMU2Slave

FILE = "servo/servo.fmu"
WANTED, GAIN, INTEGRAL = 50.0, 0.3, 1.0  # rad/s, N*m*s/rad, N*m/rad

description = read_model_description(FILE)
of = {one.name: one.valueReference for one in description.modelVariables}
folder = extract(FILE)
name = description.coSimulation.modelIdentifier
servo = FMU2Slave(guid=description.guid, unzipDirectory=folder, modelIdentifier=name, instanceName="servo")
servo.instantiate()
(panel,) = servo.getReal([of["panel"]])
step = 4 * panel  # loads that jump at edges of panels alone cost no accuracy

for inertia in (0.003, 0.006, 0.012):
    servo.setReal([of["inertia_3"]], [inertia])
    servo.setupExperiment(startTime=0.0)
    servo.enterInitializationMode()
    servo.exitInitializationMode()
    speeds, torques, total = [], [], 0.0
    for k in range(int(0.2 / step)):
        motor, wheel, torque = servo.getReal([of["velocity@0"], of["velocity@2"], of["force@1/2"]])
        total += step * (WANTED - motor)
        servo.setReal([of["load@M1"]], [GAIN * (WANTED - motor) + INTEGRAL * total])
        servo.doStep(k * step, step)
        speeds.append(wheel)
        torques.append(abs(torque))
    (lost,) = servo.getReal([of["lost"]])
    print(
        f"wheel {inertia:5.3f} kg*m^2: {max(speeds):4.1f} rad/s at most, {speeds[-1]:4.1f} at the end, "
        f"{max(torques):4.2f} N*m in the shaft, lost: {'nothing' if lost < 1e-12 else f'{lost:.0e}'}"
    )
    servo.reset()

servo.freeInstance()
rmtree(folder)
