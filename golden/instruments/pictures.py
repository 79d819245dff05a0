"""How data flow through the blocks around a network, for the picture of the datapath."""

from golden.common.flow import Carried, Flow, Step
from golden.instruments.converter_instrument import ConverterInstrument
from golden.instruments.instrument import Instrument
from golden.instruments.readout import Readout
from golden.networks.pictures import flow_of
from golden.numbers.precision import SIGNAL
from golden.visualisation.load_profile import LoadProfile

__all__ = ["flow_of"]


@flow_of.register
def _(readout: Readout) -> Flow:
    steps: list[Step] = [Carried("samples", SIGNAL), readout.network, Carried("outputs", SIGNAL)]
    if readout.load_profile:
        steps += [readout.load_profile, Carried("profile", SIGNAL)]
    elif readout.argmax:
        steps += [readout.argmax, Carried("margin", readout.argmax.margin_fmt.width)]
    return Flow(tuple(steps))


@flow_of.register
def _(instrument: Instrument) -> Flow:
    given = Carried("codes of the converter", SIGNAL)
    return Flow((given, instrument.scan_sequencer, None, instrument.readout))


@flow_of.register
def _(instrument: ConverterInstrument) -> Flow:
    given = Carried("codes of the converter", instrument.converter_reader.part.bits)
    return Flow((given, instrument.converter_reader, None, instrument.readout))


@flow_of.register
def _(profile: LoadProfile) -> Flow:
    return Flow(
        (
            profile.ramp,
            Carried("distance", profile.divider.distance_width),
            profile.divider,
            Carried("t", profile.divider.out_width),
            profile.power_fold,
            Carried("x", profile.power_fold.out_width),
            profile.exp_memory,
            Carried("word", profile.exp_memory.width),
            profile.exp_interpolator,
            Carried("exp(-x)", profile.exp_interpolator.word_width),
        ),
        across=True,
    )
