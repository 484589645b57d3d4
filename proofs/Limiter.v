(** * The limiter: how fast the thrust direction turns

    Section 3 of docs/extended-law.md, in exact arithmetic;
    controller-core/src/extended/direction_limiter.rs. p is the direction's rate, q its
    acceleration, both across it. *)

From Coq Require Import Reals Lra.
From SaturatedHybrid Require Import Space.
Open Scope R_scope.

(** (p_2, -p_1): by what a frame that turns about rho carries p. *)
Definition quarter (p : space) : space := {| x := y p; y := - x p; z := 0 |}.

(** [shortened v most]: v, at most so long. *)
Definition shortened (v : space) (most : R) : space :=
  if Rlt_dec (most * most) (square v) then scaled (most / length v) v else v.

Lemma shortened_length : forall v most, 0 <= most -> length (shortened v most) <= most.
Proof.
  intros v most Hm. unfold shortened. destruct (Rlt_dec (most * most) (square v)) as [H|H].
  - assert (Hpos : 0 < length v) by (apply sqrt_lt_R0; pose proof (squared most); lra).
    rewrite length_scaled, Rabs_pos_eq by (apply Rmult_le_pos; [lra | left; now apply Rinv_0_lt_compat]).
    right. field. lra.
  - apply length_below; lra.
Qed.

(** It is a share of v. *)
Lemma shortened_share : forall v most, 0 <= most -> exists share, 0 <= share <= 1 /\ shortened v most = scaled share v.
Proof.
  intros v most Hm. unfold shortened. destruct (Rlt_dec (most * most) (square v)) as [H|H].
  - exists (most / length v). split; [|reflexivity].
    assert (Hpos : 0 < length v) by (apply sqrt_lt_R0; pose proof (squared most); lra).
    assert (most <= length v) by (apply below_by_squares; [apply length_nonneg | rewrite length_squared; lra]).
    split; [apply Rmult_le_pos; [exact Hm | left; now apply Rinv_0_lt_compat]|].
    apply Rmult_le_reg_r with (length v); [exact Hpos|].
    replace (most / length v * length v) with most by (field; lra). lra.
  - exists 1. split; [lra | apply same; components; ring].
Qed.

Section Tick.

(** p, the wanted q, h; alpha, Omega, alpha_0 / Omega, cos gamma; e3 in the axes
    of the desired frame, across rho and along it. *)
Variables (rate wanted : space) (period alpha rate_max closing cosine : R) (across : space) (along : R).
Hypothesis alpha_positive : 0 <= alpha.
Hypothesis rate_max_positive : 0 <= rate_max.
Hypothesis period_positive : 0 < period.

(** First step: |q| <= alpha. Second: towards the vertical, and less across it.
    Third: |p + h q| <= Omega. The least divisor 1e-6 is for the edge of the cone
    alone. *)
Definition rising (q : space) : R := dot (add rate (scaled period q)) across.
Definition least_rising : R := - closing * (along - cosine).
Definition reach : R := sqrt (Rmax (square across) (1 / 1000000)).
Definition uphill : space := scaled (/ reach) across.
Definition asked_uphill : R := (least_rising / reach - dot rate uphill) / period.
Definition got_uphill : R := Rmin alpha (Rmax (- alpha) asked_uphill).
Definition left_across : R := sqrt (Rmax (alpha * alpha - got_uphill * got_uphill) 0).
Definition kept_in_cone (q : space) : space :=
  if Rle_dec least_rising (rising q) then q
  else add (shortened (sub q (scaled (dot q uphill) uphill)) left_across) (scaled got_uphill uphill).
Definition within_rate (q : space) : space :=
  if Rlt_dec (rate_max * rate_max) (square (add rate (scaled period q)))
  then shortened (scaled (/ period) (sub (shortened (add rate (scaled period q)) rate_max) rate)) alpha
  else q.
Definition turned : space := within_rate (kept_in_cone (shortened wanted alpha)).

Lemma got_within : - alpha <= got_uphill <= alpha.
Proof. unfold got_uphill. split; [apply Rmin_glb; [lra | apply Rmax_l] | apply Rmin_l]. Qed.

(** Where e3 is not along rho: [uphill] has length one, and the rest is across it. *)
Lemma uphill_parts : 1 / 1000000 <= square across -> 0 < reach /\ square uphill = 1 /\ dot uphill across = reach
  /\ forall q, dot (shortened (sub q (scaled (dot q uphill) uphill)) left_across) uphill = 0.
Proof.
  intros Hsquare. assert (Hpos : 0 < reach) by (apply sqrt_lt_R0; rewrite Rmax_left; lra).
  assert (E : reach * reach = square across) by (unfold reach; rewrite Rmax_left, sqrt_def by lra; reflexivity).
  assert (Hone : square uphill = 1).
  { unfold uphill. replace (square (scaled (/ reach) across)) with (/ reach * / reach * square across)
      by (components; ring). rewrite <- E. field. lra. }
  repeat split; [exact Hpos | exact Hone | |].
  - unfold uphill. replace (dot (scaled (/ reach) across) across) with (/ reach * square across)
      by (components; ring). rewrite <- E. field. lra.
  - intros q. destruct (shortened_share (sub q (scaled (dot q uphill) uphill)) left_across (sqrt_pos _))
      as (share & _ & ->).
    replace (dot (scaled share (sub q (scaled (dot q uphill) uphill))) uphill)
      with (share * dot q uphill * (1 - square uphill)) by (components; ring). rewrite Hone. ring.
Qed.

(** What the second step asks for holds where alpha suffices for it. *)
Theorem cone_is_kept : forall q, 1 / 1000000 <= square across -> asked_uphill <= alpha ->
  least_rising <= rising (kept_in_cone q).
Proof.
  intros q Hsquare Henough. unfold kept_in_cone. destruct (Rle_dec _ _) as [H|H]; [exact H|].
  destruct (uphill_parts Hsquare) as (Hpos & _ & Hacross & Hrest). specialize (Hrest q).
  set (rest := shortened _ left_across) in *.
  assert (E : across = scaled reach uphill) by (apply same; unfold uphill; components; field; lra).
  replace (rising (add rest (scaled got_uphill uphill)))
    with (reach * dot rate uphill + period * (reach * dot rest uphill + got_uphill * dot uphill across))
    by (unfold rising; rewrite E; components; ring).
  rewrite Hrest, Hacross.
  assert (Hgot : asked_uphill <= got_uphill) by (unfold got_uphill; apply Rmin_glb; [exact Henough | apply Rmax_r]).
  apply Rmult_le_compat_l with (r := period * reach) in Hgot; [|apply Rmult_le_pos; lra].
  replace (period * reach * asked_uphill) with (least_rising - reach * dot rate uphill) in Hgot
    by (unfold asked_uphill; field; lra). lra.
Qed.

(** No step goes beyond alpha: only where rho is out of its cone and vertical to a
    thousandth at once is nothing said. *)
Theorem turn_within_alpha :
  1 / 1000000 <= square across \/ least_rising <= rising (shortened wanted alpha) -> length turned <= alpha.
Proof.
  intros Hcase. unfold turned, within_rate. destruct (Rlt_dec _ _) as [_|_]; [now apply shortened_length|].
  unfold kept_in_cone. destruct (Rle_dec _ _) as [_|Hout]; [now apply shortened_length|].
  destruct Hcase as [Hsquare|]; [|contradiction].
  destruct (uphill_parts Hsquare) as (_ & Hone & _ & Hrest). specialize (Hrest (shortened wanted alpha)).
  assert (Hlength := shortened_length
    (sub (shortened wanted alpha) (scaled (dot (shortened wanted alpha) uphill) uphill))
    left_across (sqrt_pos _)).
  set (rest := shortened _ left_across) in *. pose proof got_within.
  assert (Hleft : left_across * left_across = alpha * alpha - got_uphill * got_uphill).
  { assert (0 <= (alpha - got_uphill) * (alpha + got_uphill)) by (apply Rmult_le_pos; lra).
    unfold left_across. rewrite Rmax_left by lra. apply sqrt_def. lra. }
  apply length_below; [exact alpha_positive|].
  replace (square (add rest (scaled got_uphill uphill)))
    with (square rest + 2 * got_uphill * dot rest uphill + got_uphill * got_uphill * square uphill)
    by (components; ring).
  rewrite Hrest, Hone. pose proof (square_below _ _ Hlength). lra.
Qed.

Lemma share_of_a_step : forall share q, 0 <= share <= 1 -> length rate <= rate_max ->
  length (add rate (scaled period q)) <= rate_max -> length (add rate (scaled period (scaled share q))) <= rate_max.
Proof.
  intros share q Hs Hin H.
  replace (add rate (scaled period (scaled share q)))
    with (add (scaled (1 - share) rate) (scaled share (add rate (scaled period q))))
    by (apply same; components; ring).
  eapply Rle_trans; [apply triangle|]. rewrite !length_scaled, !Rabs_pos_eq by lra.
  assert ((1 - share) * length rate <= (1 - share) * rate_max) by (apply Rmult_le_compat_l; lra).
  assert (share * length (add rate (scaled period q)) <= share * rate_max) by (apply Rmult_le_compat_l; lra). lra.
Qed.

(** The third step is a share of one that comes to Omega. *)
Lemma third_step : forall q, exists share q', 0 <= share <= 1 /\ within_rate q = scaled share q'
  /\ length (add rate (scaled period q')) <= rate_max.
Proof.
  intros q. unfold within_rate. destruct (Rlt_dec _ _) as [H|H].
  - set (q' := scaled (/ period) _). destruct (shortened_share q' alpha alpha_positive) as (share & Hs & ->).
    exists share, q'. repeat split; try apply Hs.
    replace (add rate (scaled period q')) with (shortened (add rate (scaled period q)) rate_max)
      by (unfold q'; apply same; components; field; lra).
    now apply shortened_length.
  - exists 1, q. repeat split; [lra | lra | apply same; components; ring | apply length_below; lra].
Qed.

Theorem rate_after_third_step : forall q, length rate <= rate_max ->
  length (add rate (scaled period (within_rate q))) <= rate_max.
Proof.
  intros q Hin. destruct (third_step q) as (share & q' & Hs & -> & H). now apply share_of_a_step.
Qed.

(** Beyond Omega it turns p inwards, whatever is wanted. *)
Theorem turned_inwards : forall q, rate_max * rate_max < square rate -> dot rate (within_rate q) <= 0.
Proof.
  intros q Hout. destruct (third_step q) as (share & v & Hs & -> & H). pose proof (square_below _ _ H) as Hsq.
  replace (square (add rate (scaled period v)))
    with (square rate + 2 * (period * dot rate v) + period * period * square v) in Hsq
    by (components; ring).
  pose proof (Rmult_le_pos _ _ (squared period) (square_nonneg v)).
  replace (dot rate (scaled share v)) with (share * dot rate v) by (components; ring).
  apply Rnot_lt_le. intros Hlt. assert (Hpos : 0 < dot rate v).
  { apply Rnot_le_lt. intros Hle. assert (0 <= share * - dot rate v) by (apply Rmult_le_pos; lra). lra. }
  pose proof (Rmult_lt_0_compat _ _ period_positive Hpos). lra.
Qed.

(** Last, the tick takes a share of it: that keeps the sign, and what is within
    Omega. *)
Definition limited (share : R) : space := scaled share turned.

Theorem share_turns_inwards : forall share, 0 <= share -> rate_max * rate_max < square rate ->
  dot rate (limited share) <= 0.
Proof.
  intros share Hs Hout. unfold limited.
  replace (dot rate (scaled share turned)) with (share * dot rate turned) by (components; ring).
  pose proof (turned_inwards (kept_in_cone (shortened wanted alpha)) Hout) as H. fold turned in H.
  assert (0 <= share * - dot rate turned) by (apply Rmult_le_pos; lra). lra.
Qed.

Theorem share_keeps_the_rate : forall share, 0 <= share <= 1 -> length rate <= rate_max ->
  length (add rate (scaled period (limited share))) <= rate_max.
Proof.
  intros share Hs Hin. apply share_of_a_step; [exact Hs | exact Hin | now apply rate_after_third_step].
Qed.

End Tick.

(** ** What a command asks for: rows "A1 turning" of the certificate

    With u' and u'' across rho and along it: |p| and |q| of a command whose
    derivatives are bounded. *)
Theorem turning_of_a_command : forall (u_1 u_2 : space) radial radial_2 n jerk snap least,
  square u_1 + radial * radial <= jerk * jerk -> square u_2 + radial_2 * radial_2 <= snap * snap ->
  0 < least <= n -> 0 <= jerk -> 0 <= snap ->
  let p := scaled (/ n) u_1 in
  let q := scaled (/ n) (sub u_2 (scaled (2 * radial) p)) in
  length p <= jerk / least /\ length q <= snap / least + jerk / least * (jerk / least).
Proof.
  intros u_1 u_2 r r_2 n jerk snap least H1 H2 Hn Hj Hs p q.
  assert (Hinv : 0 < / n <= / least) by (split; [apply Rinv_0_lt_compat | apply Rinv_le_contravar]; lra).
  pose proof (square_nonneg u_1). pose proof (squared r). pose proof (squared r_2).
  assert (Hu1 : length u_1 <= jerk) by (apply length_below; lra).
  assert (Hu2 : length u_2 <= snap) by (apply length_below; lra).
  assert (Hn1 : forall v, length (scaled (/ n) v) = / n * length v)
    by (intros; rewrite length_scaled, Rabs_pos_eq; lra).
  pose proof (length_nonneg u_1). pose proof (length_nonneg u_2).
  assert (Hp : length p <= jerk / least).
  { unfold p. rewrite Hn1, Rmult_comm. apply Rmult_le_compat; lra. }
  split; [exact Hp|]. unfold q. rewrite Hn1.
  assert (Hsum : length (sub u_2 (scaled (2 * r) p)) <= snap + Rabs (2 * r) * length p).
  { eapply Rle_trans; [apply triangle_sub|]. rewrite length_scaled. lra. }
  (* 2 |r| |u'_12| is at most the square of both. *)
  assert (Hboth : Rabs (2 * r) * length u_1 <= jerk * jerk).
  { rewrite Rabs_mult, (Rabs_pos_eq 2) by lra. pose proof (squared (Rabs r - length u_1)) as Hq.
    pose proof (length_squared u_1). assert (Rabs r * Rabs r = r * r) by (rewrite <- Rabs_mult; now apply Rabs_pos_eq).
    lra. }
  apply Rle_trans with (/ n * (snap + Rabs (2 * r) * length p)); [apply Rmult_le_compat_l; lra|].
  replace (/ n * (snap + Rabs (2 * r) * length p)) with (snap * / n + / n * / n * (Rabs (2 * r) * length u_1))
    by (unfold p; rewrite Hn1; ring).
  apply Rplus_le_compat; [apply Rmult_le_compat_l; lra|].
  replace (jerk / least * (jerk / least)) with (/ least * / least * (jerk * jerk)) by (unfold Rdiv; ring).
  apply Rmult_le_compat; [apply Rmult_le_pos; lra | apply Rmult_le_pos; [apply Rabs_pos | assumption] | | exact Hboth].
  apply Rmult_le_compat; lra.
Qed.
