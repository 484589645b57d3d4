(** * The fallback: a slowed law, and progress

    Section 13 of docs/extended-law.md, in exact arithmetic;
    controller-core/src/extended/fallback.rs. *)

From Coq Require Import Reals Lra Arith.
From Coquelicot Require Import Coquelicot.
From SaturatedHybrid Require Import Space Envelope.
Open Scope R_scope.

(** ** The filters stay within a level *)

(** A filter of bandwidth k whose input stays within M, and that starts there,
    does not leave it: so y + d, x + d and c + d, one after the other. *)
Theorem filter_stays : forall (input out : R -> space) k M, 0 <= k -> 0 <= M ->
  (forall s, 0 <= s -> moves out s (scaled k (sub (input s) (out s)))) ->
  (forall s, 0 <= s -> square (input s) <= M * M) -> square (out 0) <= M * M ->
  forall t, 0 <= t -> square (out t) <= M * M.
Proof.
  intros input out k M Hk HM Hout Hin H0. refine (length_is_bounded _ _ M Hout _ H0). intros s Hs Hbeyond.
  replace (dot (out s) (scaled k (sub (input s) (out s)))) with (- (k * (square (out s) - dot (out s) (input s))))
    by (components; ring).
  (* |out| is greater than M, and |input| is not. *)
  pose proof (Rle_abs (dot (out s) (input s))). pose proof (cauchy_schwarz (out s) (input s)).
  pose proof (length_squared (out s)).
  assert (Hi : length (input s) <= M) by (apply length_below; [exact HM | now apply Hin]).
  assert (Ho : M <= length (out s)) by (apply below_by_squares; [apply length_nonneg | lra]).
  assert (length (out s) * length (input s) <= length (out s) * length (out s))
    by (apply Rmult_le_compat_l; [apply length_nonneg | lra]).
  assert (0 <= k * (square (out s) - dot (out s) (input s))) by (apply Rmult_le_pos; lra). lra.
Qed.

(** So the command changes slowly: c' = k_f (x - c), x' = k_s (y - x). *)
Definition command_rate (k_f : R) (c x_ : space) : space := scaled k_f (sub x_ c).
Definition command_acceleration (k_f k_s : R) (c x_ y_ : space) : space :=
  scaled k_f (sub (scaled k_s (sub y_ x_)) (command_rate k_f c x_)).

Theorem slow_derivatives : forall k_f k_s M c x_ y_, 0 <= k_f -> 0 <= k_s ->
  length c <= M -> length x_ <= M -> length y_ <= M ->
  length (command_rate k_f c x_) <= 2 * k_f * M
  /\ length (command_acceleration k_f k_s c x_ y_) <= 2 * k_f * (k_s + k_f) * M.
Proof.
  intros k_f k_s M c x_ y_ Hf Hs Hc Hx Hy.
  assert (Hstep : forall k u v, 0 <= k -> length u <= M -> length v <= M -> length (scaled k (sub u v)) <= k * (2 * M)).
  { intros k u v Hk Hu Hv. rewrite length_scaled, Rabs_pos_eq by exact Hk. apply Rmult_le_compat_l; [exact Hk|].
    pose proof (triangle_sub u v). lra. }
  pose proof (Hstep k_f x_ c Hf Hx Hc) as Hrate. fold (command_rate k_f c x_) in Hrate. split; [lra|].
  unfold command_acceleration. rewrite length_scaled, Rabs_pos_eq by exact Hf.
  replace (2 * k_f * (k_s + k_f) * M) with (k_f * (k_s * (2 * M) + k_f * (2 * M))) by ring.
  apply Rmult_le_compat_l; [exact Hf|]. eapply Rle_trans; [apply triangle_sub|].
  pose proof (Hstep k_s y_ x_ Hs Hy Hx). lra.
Qed.

(** Within a level across and within it along the vertical: within M = sqrt 2
    times the level. *)
Theorem both_together : forall v level, 0 <= level ->
  x v * x v + y v * y v <= level * level -> z v * z v <= level * level -> length v <= sqrt 2 * level.
Proof.
  intros v level Hl Ha Hv. pose proof (sqrt_pos 2). apply length_below; [now apply Rmult_le_pos|].
  replace (sqrt 2 * level * (sqrt 2 * level)) with (sqrt 2 * sqrt 2 * (level * level)) by ring.
  rewrite sqrt_def by lra. components. lra.
Qed.

(** ** Progress

    Of each window of the law's own bandwidths in which the vehicle is not near:
    the greatest |p~| and |v~|. *)

Definition less (now best : R) : Prop := 1 / 2 < best /\ now < best - Rmin (1 / 10 * best) 5.

(** What progress is counted from: the greatest |p~| of the last window, and the
    least of the windows' greatest |v~|. The next window makes progress in either
    of two ways. *)
Definition progress (distance speed distance_next speed_next : R) : Prop :=
  less speed_next speed \/ speed_next = speed /\ less distance_next distance.

Lemma less_by : forall now best, less now best -> now + 1 / 20 <= best.
Proof. intros now best [H1 H2]. unfold Rmin in H2. destruct (Rle_dec _ _); lra. Qed.

(** Windows with progress do not follow each other for good: so at some time the
    vehicle is near, or the law changes. *)
Theorem progress_ends : forall distance speed : nat -> R,
  ~ forall n, progress (distance n) (speed n) (distance (S n)) (speed (S n)).
Proof.
  intros d v Hprogress.
  assert (Hup : forall x, exists k, 20 * x <= INR k).
  { intros x. destruct (nfloor_ex (Rmax (20 * x) 0) (Rmax_r _ _)) as [k Hk]. exists (S k). rewrite S_INR.
    pose proof (Rmax_l (20 * x) 0). lra. }
  assert (H : forall k n, 20 * v n <= INR k -> False).
  { induction k as [|k IHk]; intros n Hv; destruct (Hup (d n)) as [j Hd]; revert n Hv Hd;
      induction j as [|j IHj]; intros n Hv Hd;
      (destruct (Hprogress n) as [Hslower|[E Hnearer]];
        [pose proof (less_by _ _ Hslower); destruct Hslower as [Hover _]
        |pose proof (less_by _ _ Hnearer); destruct Hnearer as [Hover _]]);
      rewrite ?S_INR in *; cbn [INR] in *; try lra.
    - apply (IHj (S n)); lra.
    - apply (IHk (S n)). lra.
    - apply (IHk (S n)). lra.
    - apply (IHj (S n)); lra. }
  destruct (Hup (v 0%nat)) as [k Hk]. exact (H k 0%nat Hk).
Qed.

(** Until then |p~| stays below a bound that the first window gives. In a window
    whose |v~| is the least so far, |p~| grows by no more than that times the
    window's length W; in any other it falls. *)
Theorem progress_is_bounded : forall (distance speed : nat -> R) W, 0 <= W ->
  (forall n, 0 <= speed n) -> (forall n, distance (S n) <= distance n + W * speed (S n)) ->
  forall m, (forall n, (n < m)%nat -> progress (distance n) (speed n) (distance (S n)) (speed (S n))) ->
  speed m <= speed 0%nat /\ distance m <= distance 0%nat + 20 * W * (speed 0%nat * speed 0%nat).
Proof.
  intros d v W HW Hv Hgrows m Hprogress.
  enough (H : v m <= v 0%nat /\ d m + 20 * W * v 0%nat * v m <= d 0%nat + 20 * W * v 0%nat * v 0%nat).
  { assert (0 <= 20 * W * v 0%nat * v m) by (repeat apply Rmult_le_pos; try lra; apply Hv). lra. }
  induction m as [|m IH]; [lra|]. specialize (IH (fun n Hn => Hprogress n (Nat.lt_lt_succ_r _ _ Hn))).
  specialize (Hprogress m (Nat.lt_succ_diag_r m)). specialize (Hgrows m).
  pose proof (Hv 0%nat). assert (HWv : 0 <= W * v 0%nat) by now apply Rmult_le_pos.
  destruct Hprogress as [Hslower|[E Hnearer]].
  - pose proof (less_by _ _ Hslower) as Hless.
    assert (W * v (S m) <= W * v 0%nat) by (apply Rmult_le_compat_l; lra).
    pose proof (Rmult_le_compat_l (20 * (W * v 0%nat)) _ _ ltac:(lra) Hless). lra.
  - pose proof (less_by _ _ Hnearer). rewrite E. lra.
Qed.
