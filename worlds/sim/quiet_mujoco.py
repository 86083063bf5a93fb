"""MuJoCo without its warnings: what they say is told in other ways, or is no news."""


def quiet_mujoco() -> None:
    """Let MuJoCo neither litter the screen nor write a file into the working folder.

    Its log is one for the whole process, and stays so.
    """
    import mujoco

    log = mujoco.MjLogConfig.get()
    log.logto_console = log.logto_file = False
    log.set()
