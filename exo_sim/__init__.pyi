from exo_sim.api.comparing import Comparison as Comparison
from exo_sim.api.comparing import compare as compare
from exo_sim.api.diagnosing import Diagnosis as Diagnosis
from exo_sim.api.diagnosing import diagnose as diagnose
from exo_sim.api.doctor import doctor as doctor
from exo_sim.api.effects import effects as effects
from exo_sim.api.errors import ExoSimError as ExoSimError
from exo_sim.api.inspecting import Inspection as Inspection
from exo_sim.api.inspecting import inspect as inspect
from exo_sim.api.model_logging import log_model as log_model
from exo_sim.api.recording import Recording as Recording
from exo_sim.api.rig import Rig as Rig
from exo_sim.api.simulated import Run as Run
from exo_sim.api.simulating import scenarios as scenarios
from exo_sim.api.simulating import simulate as simulate
from exo_sim.api.sizing import Sizing as Sizing
from exo_sim.api.sizing import size as size
from exo_sim.api.stepping import Simulation as Simulation

__version__: str
