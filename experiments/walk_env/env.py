"""The walking robot as a Gymnasium environment, and the worlds of its episodes."""

import copy
import math
from pathlib import Path
from typing import TYPE_CHECKING, Any, ClassVar, Literal, TypeAlias, get_args

import gymnasium as gym
import numpy as np
from gymnasium.error import ResetNeeded
from gymnasium.spaces import Box

import robots
import worlds
from experiments.runs.gait_files import load_gait
from experiments.walk_env.episode import WalkEpisode
from experiments.walking.trials import SEARCH_TRIAL, TrialRules, reward_cm_s
from groundwalk.arrays import FloatArray
from groundwalk.errors import BadValueError, UnknownNameError
from robots import Description
from robots.leg_geometry import FOOT_SENSORS
from terrain import Heightfield, TerrainSpec, parse
from walk_engine import PARAMETERS, Gait
from walk_engine.gait import from_unit
from worlds import FALLS, TICK_S, World, WorldOptions

if TYPE_CHECKING:
    from sgat.transformers.catalogue import Transformer

WorldName = Literal["sim", "real", "grounded"]


class EnvWorld:
    """Makes an episode's world, with one robot, from the arguments of `WalkEnv`."""

    def __init__(
        self,
        name: WorldName,
        description: Description,
        terrain: str | Heightfield | None,
        transformer: "Transformer | str | Path | None",
        options: WorldOptions | None,
    ) -> None:
        """Refuse arguments that do not fit together; read or copy the transformer.

        A copy, so that no two environments share one.
        """
        if name not in get_args(WorldName):
            raise UnknownNameError("world", name, get_args(WorldName))
        if (name == "grounded") != (transformer is not None):
            raise BadValueError(
                "a grounded world, and no other, needs a transformer: an object, or "
                "the folder that sgat.transformers.catalogue has written"
            )
        self._inner = "sim" if name == "grounded" else name
        self._description, self._options = description, options
        self._terrain = terrain or worlds.kind(self._inner).terrain
        if isinstance(self._terrain, str):
            parse(self._terrain)
        if isinstance(transformer, str | Path):
            from sgat.transformers.catalogue import read_transformer

            self._transformer: Transformer | None = read_transformer(Path(transformer))
        else:
            self._transformer = copy.deepcopy(transformer)

    def make(
        self, of_ground: np.random.SeedSequence, of_noise: np.random.SeedSequence
    ) -> World:
        """The world of one episode, from the seeds of its ground and of its noise."""
        ground, robot = self._terrain, self._description
        if isinstance(ground, str):
            number = int(of_ground.generate_state(1)[0])
            ground = TerrainSpec(*parse(ground), seed=number).make()
        world = worlds.make(self._inner, robot, [ground], [of_noise], self._options)
        if self._transformer is None:
            return world

        from sgat.walks.walk_senses import leg_senses
        from sgat.walks.wrapped_worlds import GroundedWorld

        return GroundedWorld(world, leg_senses(robot), self._transformer, [of_noise])


def episode_seeds(
    generator: np.random.Generator,
) -> tuple[np.random.SeedSequence, np.random.SeedSequence, np.random.SeedSequence]:
    """Seeds of an episode's ground, its noise and its start pose."""
    root = np.random.SeedSequence(int(generator.integers(2**63)))
    ground, noise, pose = root.spawn(3)
    return ground, noise, pose


ActionKind = Literal["residual", "gait"]
Info = dict[str, Any]
Environment: TypeAlias = gym.Env[Any, Any]


class WalkEnv(Environment):
    """One robot that walks straight ahead for 7.5 s, or until it falls.

    ## Action space

    | `action` | space | what it is |
    |---|---|---|
    | `"residual"` | `Box(-1, 1, (joints,), float32)` | times `residual_rad`, added to the walk engine's joint commands for one tick of 10 ms |
    | `"gait"` | `Box(-1, 1, (16,), float32)` | a gait, each parameter's bounds at -1 and 1, in the order of `walk_engine.PARAMETERS`; one step is a whole rollout |

    ## Observation space

    `Box(76, float64)` for the NAO with its 20 joints, measured on board and held within
    the sensors' bounds; noisy and late in the real world. After a rollout in the mode
    `"gait"` it is that of the last tick.

    | columns | what it is | unit | bounds |
    |---|---|---|---|
    | 0 to 19 | joint positions | rad | ±2π |
    | 20 to 39 | joint velocities | rad/s | ±50 |
    | 40 to 42 | gyroscope, torso frame | rad/s | ±50 |
    | 43 to 45 | accelerometer, torso frame | m/s² | ±1000 |
    | 46 to 53 | foot forces: four of the left foot, four of the right | N | 0 to 10000 |
    | 54 to 73 | what the walk engine commands next | rad | ±2π |
    | 74 | the foot that supports: 1 left, -1 right, 0 both | 1 | ±1 |
    | 75 | time since the step began | s | 0 to 10 |

    ## Reward

    Forward progress [cm] divided by `limit_s` [s], minus 15 for a fall; the sum over an
    episode is `experiments.walking.trials.reward_cm_s` [cm/s].

    ## Start

    Upright and crouched in the engine's pose with normal noise of `start_spread_rad`,
    on ground of its own: terrain, sensor noise, pose and the transformer's noise follow
    from the seed of `reset`.

    ## End

    Terminated by a fall, or physics that blow up; in the mode `"gait"` after its one
    step. Truncated when `limit_s` are over, or the robot walks off its ground.

    `info` has `distance_m`, `time_s` and `ended`.

    ## Arguments

    See `__init__`. The ids `Groundwalk/Nao-Sim-v0`, `-Real-v0` and `-Grounded-v0` of
    `experiments.walk_env` differ in `world`.

    ## Version history

    - v0: first.
    """  # noqa: E501  # tables cannot be broken

    metadata: ClassVar[dict[str, Any]] = {"render_modes": []}  # type: ignore[misc]

    def __init__(
        self,
        world: WorldName = "sim",
        *,
        action: ActionKind = "residual",
        robot: str | Description = "nao",
        gait: str | Gait = "start",
        terrain: str | Heightfield | None = None,
        limit_s: float = SEARCH_TRIAL.limit_s,
        residual_rad: float = 0.1,
        start_spread_rad: float = 0.01,
        transformer: "Transformer | str | Path | None" = None,
        options: WorldOptions | None = None,
    ) -> None:
        """Choose the robot, its gait and its world; nothing is simulated yet.

        Args:
          world: "sim", "real", or "grounded": the sim behind an action transformer.
          action: meaning of an action; see the class.
          robot: name of a robot, or a description.
          gait: gait to whose commands residual actions are added: a name, a JSON file
            or a gait.
          terrain: ground in words, such as "lumps:amplitude_m=0.005", drawn anew at
            each reset, or a fixed ground; the world's own if None.
          limit_s: time limit of an episode [s].
          residual_rad: what an action of 1 adds to a joint's command [rad].
          start_spread_rad: standard deviation of the joints at the start [rad].
          transformer: action transformer of a grounded world: an object, which is
            copied, or a folder that `sgat.transformers.write_transformer` has written.
          options: options of the world, such as its latency; its own if None.

        Raises:
          BadValueError: a value is impossible, or world and transformer do not fit.
          UnknownNameError: there is no such world, kind of action, robot or gait.
        """
        if action not in get_args(ActionKind):
            raise UnknownNameError("kind of action", action, get_args(ActionKind))
        if not 0 < residual_rad < np.inf:
            raise BadValueError(f"residual_rad is {residual_rad}; it must be positive")
        description = robots.get(robot) if isinstance(robot, str) else robot
        self._place = EnvWorld(world, description, terrain, transformer, options)
        self._gait = load_gait(gait) if isinstance(gait, str) else gait
        self._rules = TrialRules(limit_s, start_spread_rad=start_spread_rad)
        self._residual_rad = residual_rad
        self._action = action
        self._joints = len(description.joints)
        wide = self._joints if action == "residual" else len(PARAMETERS)
        self.action_space = Box(-1.0, 1.0, (wide,), np.float32)
        self._box = self.observation_space = _observation_space(self._joints)
        self._world: World | None = None
        self._episode: WalkEpisode | None = None

    def reset(
        self, *, seed: int | None = None, options: Info | None = None
    ) -> tuple[FloatArray, Info]:
        """Start an episode, and return the observation and `info` of the class.

        Everything random in it, and in all episodes that follow, comes from the seed;
        see `gymnasium.Env.reset`. `options` are not used.
        """
        super().reset(seed=seed)
        self.close()
        of_ground, of_noise, self._of_pose = episode_seeds(self.np_random)
        self._world = self._place.make(of_ground, of_noise)
        return self._told(self._begin(self._gait))

    def step(self, action: FloatArray) -> tuple[FloatArray, float, bool, bool, Info]:
        """One tick with a residual (joints,), or one whole rollout with a gait (16,).

        Returns:
          Observation, reward, terminated, truncated and `info`; see the class.
        """
        episode = self._episode
        if episode is None:
            raise ResetNeeded("call reset before step")
        asked = np.clip(np.asarray(action, float), -1.0, 1.0)
        if self._action == "gait":
            episode = self._begin(Gait.from_vector(from_unit((asked + 1.0) / 2.0)))
            before = 0.0
            while not episode.is_over:
                episode.step(np.zeros(self._joints))
        else:
            before = self._worth(episode)
            if not episode.is_over:
                episode.step(self._residual_rad * asked)
        reward = self._worth(episode) - before
        terminated = episode.ended in FALLS or self._action == "gait"
        truncated = episode.is_over and not terminated
        seen, info = self._told(episode)
        return seen, reward, terminated, truncated, info

    def close(self) -> None:
        """Close the world and its processes."""
        if self._world is not None:
            self._world.close()
        self._world = self._episode = None

    def _begin(self, gait: Gait) -> WalkEpisode:
        assert self._world is not None
        self._episode = WalkEpisode(self._world, gait, self._rules, self._of_pose)
        return self._episode

    def _worth(self, episode: WalkEpisode) -> float:
        return float(reward_cm_s(episode.trials(), self._rules.limit_s)[0])

    def _told(self, episode: WalkEpisode) -> tuple[FloatArray, Info]:
        """Observation and `info` after the last tick."""
        seen = np.clip(episode.senses(), self._box.low, self._box.high)
        return np.asarray(seen), {
            "distance_m": episode.distance_m,
            "time_s": episode.ticks * TICK_S,
            "ended": str(episode.ended),
        }


def _observation_space(joints: int) -> Box:
    turn_rad, fastest_rad_s, hardest_m_s2 = 2 * math.pi, 50.0, 1000.0
    columns = (
        (joints, -turn_rad, turn_rad),
        (joints, -fastest_rad_s, fastest_rad_s),
        (3, -fastest_rad_s, fastest_rad_s),
        (3, -hardest_m_s2, hardest_m_s2),
        (FOOT_SENSORS, 0.0, 10_000.0),
        (joints, -turn_rad, turn_rad),
        (1, -1.0, 1.0),
        (1, 0.0, 10.0),
    )
    counts, low, high = zip(*columns, strict=True)
    return Box(np.repeat(low, counts), np.repeat(high, counts), dtype=np.float64)
