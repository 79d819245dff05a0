"""How data flow through the blocks around a network, for the picture of the datapath."""

from golden.instruments.converter_instrument import ConverterInstrument
from golden.instruments.instrument import Instrument
from golden.instruments.readout import Readout
from golden.networks.pictures import Flow, Step, Wire, flow_of
from golden.numbers.precision import SIGNAL
from golden.visualisation.load_profile import LoadProfile

__all__ = ["flow_of"]


@flow_of.register
def _(readout: Readout) -> Flow:
    steps: list[Step] = [Wire("samples", SIGNAL), readout.network, Wire("outputs", SIGNAL)]
    if readout.load_profile:
        steps += [readout.load_profile, Wire("profile", SIGNAL)]
    elif readout.argmax:
        steps += [readout.argmax, Wire("margin", readout.argmax.margin_fmt.width)]
    return Flow(tuple(steps))


@flow_of.register
def _(instrument: Instrument) -> Flow:
    given = Wire("codes of the converter", SIGNAL)
    return Flow((given, instrument.scan_sequencer, None, instrument.readout))


@flow_of.register
def _(instrument: ConverterInstrument) -> Flow:
    given = Wire("codes of the converter", instrument.converter_reader.part.bits)
    return Flow((given, instrument.converter_reader, None, instrument.readout))


@flow_of.register
def _(profile: LoadProfile) -> Flow:
    return Flow(
        (
            profile.ramp,
            Wire("distance", profile.divider.distance_width),
            profile.divider,
            Wire("t", profile.divider.out_width),
            profile.power_fold,
            Wire("x", profile.power_fold.out_width),
            profile.exp_memory,
            Wire("word", profile.exp_memory.width),
            profile.exp_interpolator,
            Wire("exp(-x)", profile.exp_interpolator.word_width),
        ),
        across=True,
    )
